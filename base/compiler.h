/* Macros for compiler attributes that C11 lacks, and the length of an array. */
#ifndef GOPURA_BASE_COMPILER_H
#define GOPURA_BASE_COMPILER_H

/* For every function whose failure a caller could overlook. */
#define must_check __attribute__((warn_unused_result))
#define printf_like(format_index, first_index)                                                     \
	__attribute__((format(printf, format_index, first_index)))

#define ARRAY_COUNT(array) (sizeof(array) / sizeof((array)[0]))

#endif
