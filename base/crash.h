/* What a crash leaves on standard error before the program ends as it would have: the signal, and
 * the calls that led there, each as an offset into a program or library (addr2line -f -e PROGRAM
 * OFFSET). A panel in a museum has nobody with a debugger beside it. */
#ifndef GOPURA_BASE_CRASH_H
#define GOPURA_BASE_CRASH_H

/* Tells crashes of this process from now on, of any thread that does not block their signals
 * (base/thread.h), and SIGABRT from outside too: the watchdog's shows where a program hangs.
 * module: as in log_line; a literal. Under the sanitizers, which tell more, it does nothing. */
void crash_tell(const char *module);

#endif
