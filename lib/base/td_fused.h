/* Internal: code for processors that have fused multiply-add as an instruction. */
#ifndef TD_FUSED_H
#define TD_FUSED_H

/* The library is built for any x86-64, where each fma() is a call of libm that saves all registers: half of the scalar
 * references' time. Files that use fma() much are compiled a second time between TD_FUSED_BEGIN and TD_FUSED_END. That copy is
 * called if td_has_fused. The bits are equal: an fma has one correct result (IEEE 754), and nothing is contracted
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
