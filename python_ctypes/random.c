/* Random bytes for expat's tables, in the wheel's tool. The C library has this function since 2.36; without a call of it the wheel goes
 * where that is 2.35 (Ubuntu 22.04). */
#define _DEFAULT_SOURCE 1
#include <errno.h>
#include <stddef.h>
#include <sys/random.h>

void arc4random_buf(void *bytes, size_t size);

/* Where the kernel gives none, the caller keeps what its memory held: a salt against crafted XML, of which fontconfig reads none. */
void arc4random_buf(void *bytes, size_t size) {
    for (char *at = bytes; size;) {
        const ssize_t got = getrandom(at, size, 0);
        if (got < 0 && errno != EINTR) return;
        if (got > 0) {
            at += got;
            size -= (size_t)got;
        }
    }
}
