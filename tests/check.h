/* What every unit test needs: cmocka, and CHECK, which names the broken claim. */
#ifndef GOPURA_TESTS_CHECK_H
#define GOPURA_TESTS_CHECK_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#define CHECK(claim)                                                                               \
	do {                                                                                       \
		if (!(claim))                                                                      \
			fail_msg("not true: %s", #claim);                                          \
	} while (0)

#endif
