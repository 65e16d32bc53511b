/* Code for processors that have fused multiply-add as an instruction. */
#ifndef TD_FUSED_H
#define TD_FUSED_H

/* A library for any x86-64 calls libm for each fma(), which saves all registers around it: half of the time of the references,
 * which are written in terms of it. Such files are compiled a second time between these two lines, and what they make is taken
 * where the processor allows it. The bits are the same: an fma has one result (IEEE 754), nothing is contracted
 * (-ffp-contract) or reordered (tests/kernels/test_fused.c). */
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__)
#define TD_FUSED
#define TD_FUSED_BEGIN _Pragma("GCC push_options") _Pragma("GCC target(\"avx2,fma\")")
#define TD_FUSED_END _Pragma("GCC pop_options")
#elif defined(__clang__) && defined(__x86_64__)
#define TD_FUSED
#define TD_FUSED_BEGIN _Pragma("clang attribute push(__attribute__((target(\"avx2,fma\"))), apply_to = function)")
#define TD_FUSED_END _Pragma("clang attribute pop")
#endif

static inline int td_has_fused(void) {
#ifdef TD_FUSED
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
    return 0;
#endif
}

#endif
