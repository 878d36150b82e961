/* Macros for compiler attributes that C11 lacks, and the length of an array. */
#ifndef GOPURA_BASE_COMPILER_H
#define GOPURA_BASE_COMPILER_H

/* For every function whose failure a caller could overlook. */
#define must_check __attribute__((warn_unused_result))
#define printf_like(format_index, first_index)                                                     \
	__attribute__((format(printf, format_index, first_index)))
/* For a function so short and so often called that the call itself would take much of its time. */
#define force_inline inline __attribute__((always_inline))

/* For functions with loops over many numbers: compiled once more for each kind of vector unit, and
 * the processor's own is chosen when the program starts. All give the same bits. */
#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define vector_clones __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define vector_clones
#endif
/* For what such functions call. */
#define vector_inline static inline __attribute__((always_inline))

#define ARRAY_COUNT(array) (sizeof(array) / sizeof((array)[0]))

#endif
