/* Declares the functions of OpenCL C that kernels call. Only PoCL's programs include it (lib/device/program.c): otherwise clang
 * reads 900 KB of declarations for each program, also where PoCL has its binary on disk. A program on disk then loads in a
 * third of the time, and others build 0.2 s faster. The functions are the driver's in both cases, so that code and bits are
 * equal. `make lint` compiles every program with these declarations alone. */
#ifndef TD_BUILTINS_H
#define TD_BUILTINS_H

/* Properties that clang may assume of a function, as its own header declares them. */
#define TD_BUILTIN __attribute__((overloadable))
#define TD_BUILTIN_PURE __attribute__((overloadable, pure))
#define TD_BUILTIN_CONST __attribute__((overloadable, const))

/* Loads a vector of n values of `type` from an array, and stores it. */
#define TD_DECLARE_MOVES(type, n)                                     \
    TD_BUILTIN_PURE type##n vload##n(size_t, const __global type *);  \
    TD_BUILTIN_PURE type##n vload##n(size_t, const __private type *); \
    TD_BUILTIN void vstore##n(type##n, size_t, __global type *);      \
    TD_BUILTIN void vstore##n(type##n, size_t, __private type *);

#define TD_DECLARE_ARITHMETIC(real, mask)        \
    TD_BUILTIN_CONST real sqrt(real);            \
    TD_BUILTIN_CONST real fma(real, real, real); \
    TD_BUILTIN_CONST real select(real, real, mask);

#define TD_DECLARE_ORDER(type)             \
    TD_BUILTIN_CONST type min(type, type); \
    TD_BUILTIN_CONST type max(type, type);

#define TD_DECLARE_VECTORS(n)                           \
    TD_DECLARE_MOVES(int, n)                            \
    TD_DECLARE_MOVES(float, n)                          \
    TD_DECLARE_ARITHMETIC(float##n, int##n)             \
    TD_BUILTIN_CONST float##n convert_float##n(int##n); \
    TD_BUILTIN_CONST float##n convert_float##n(float##n);

TD_DECLARE_ARITHMETIC(float, int)
TD_DECLARE_VECTORS(4)
TD_DECLARE_VECTORS(8)
TD_DECLARE_VECTORS(16)

#ifdef TD_REAL_DOUBLE
#define TD_DECLARE_WIDE_VECTORS(n)                          \
    TD_DECLARE_MOVES(double, n)                             \
    TD_DECLARE_ARITHMETIC(double##n, long##n)               \
    TD_BUILTIN_CONST float##n convert_float##n(double##n);  \
    TD_BUILTIN_CONST double##n convert_double##n(float##n); \
    TD_BUILTIN_CONST double##n convert_double##n(long##n);  \
    TD_BUILTIN_CONST long##n convert_long##n(int##n);       \
    TD_BUILTIN_CONST int##n convert_int##n(long##n);

TD_DECLARE_ARITHMETIC(double, long)
TD_DECLARE_WIDE_VECTORS(4)
TD_DECLARE_WIDE_VECTORS(8)
TD_DECLARE_WIDE_VECTORS(16)
#endif

TD_DECLARE_MOVES(long, 8)
TD_DECLARE_ORDER(int)
TD_DECLARE_ORDER(long)
TD_DECLARE_ORDER(long8)
TD_BUILTIN_CONST int popcount(int);
TD_BUILTIN_CONST uint popcount(uint);
TD_BUILTIN_CONST int clz(int);
TD_BUILTIN_CONST uint clz(uint);
TD_BUILTIN int atomic_inc(volatile __global int *);

TD_BUILTIN_CONST size_t get_global_id(uint);
TD_BUILTIN_CONST size_t get_global_size(uint);
TD_BUILTIN_CONST size_t get_group_id(uint);
TD_BUILTIN_CONST size_t get_local_id(uint);
TD_BUILTIN_CONST size_t get_local_size(uint);
TD_BUILTIN __attribute__((convergent)) void barrier(cl_mem_fence_flags);

#endif
