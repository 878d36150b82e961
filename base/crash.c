/* Handlers that write with nothing but what a signal handler may call, and let the signal come
 * again. */
#include "base/crash.h"

#include <execinfo.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/array.h"

#ifdef __SANITIZE_ADDRESS__
enum { TELLS = 0 };
#else
enum { TELLS = 1 };
#endif
enum { CALLS_MAX = 48, STACK_BYTES = 64 << 10, PATIENCE_S = 5 };

static const struct {
	int number;
	const char *name;
} signals[] = {
	{ SIGSEGV, "SIGSEGV" }, { SIGBUS, "SIGBUS" },   { SIGILL, "SIGILL" },
	{ SIGFPE, "SIGFPE" },   { SIGABRT, "SIGABRT" },
};
static struct sigaction before[ARRAY_COUNT(signals)];
static char begin[64]; /* of the line that the handler writes, which may not format */

/* The default action, or whatever was there before, then ends the program. */
static void on_crash(int number)
{
	static const char middle[] = "; the calls, last first:\n";
	void *calls[CALLS_MAX];
	const char *name = "";

	alarm(PATIENCE_S); /* what crashed may hold a lock that backtrace needs */
	for (size_t i = 0; i < ARRAY_COUNT(signals); i++) {
		sigaction(signals[i].number, &before[i], NULL);
		if (signals[i].number == number)
			name = signals[i].name;
	}
	if (write(STDERR_FILENO, begin, strlen(begin)) > 0 &&
	    write(STDERR_FILENO, name, strlen(name)) > 0 &&
	    write(STDERR_FILENO, middle, sizeof(middle) - 1) > 0)
		backtrace_symbols_fd(calls, backtrace(calls, CALLS_MAX), STDERR_FILENO);
	raise(number); /* blocked until this returns */
}

void crash_tell(const char *module)
{
	static uint8_t stack[STACK_BYTES]; /* a stack that overflowed has no room for the handler */
	const stack_t alternate = { .ss_sp = stack, .ss_size = sizeof(stack) };
	struct sigaction action = { .sa_handler = on_crash, .sa_flags = SA_ONSTACK };
	void *call;

	if (!TELLS)
		return;
	snprintf(begin, sizeof(begin), "%s%s: crashed by ",
		 getenv("JOURNAL_STREAM") ? "<3>" : "error: ", module);
	backtrace(&call, 1); /* loads libgcc, which allocates */
	sigaltstack(&alternate, NULL);
	sigfillset(&action.sa_mask);
	sigdelset(&action.sa_mask, SIGALRM);
	for (size_t i = 0; i < ARRAY_COUNT(signals); i++)
		sigaction(signals[i].number, &action, &before[i]);
}
