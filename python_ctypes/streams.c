/* stderr and stdout for archives that go into the wheel's library. Distributions compile them for programs, which may reach the C
 * library's variables directly; a shared library may not (ld: recompile with -fPIC). With ld's --wrap they reach these. */
#include <stdio.h>

extern FILE *__real_stderr, *__real_stdout;
__attribute__((visibility("hidden"))) FILE *__wrap_stderr, *__wrap_stdout;

__attribute__((constructor)) static void td_set_streams(void) {
    __wrap_stderr = __real_stderr;
    __wrap_stdout = __real_stdout;
}
