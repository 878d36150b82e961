/* For LD_PRELOAD: the clock counts as set by a time server, whatever the machine of the test says,
 * so that expiry is judged. */
#include <string.h>
#include <sys/timex.h>

int adjtimex(struct timex *state)
{
	memset(state, 0, sizeof(*state));
	return TIME_OK;
}
