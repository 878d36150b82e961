/* Reads the errors that OpenSSL has noted on this thread. */
#include "tuf/openssl_memory.h"

#include <openssl/err.h>

bool openssl_lacked_memory(void)
{
	unsigned long error;
	bool lacked = false;

	while ((error = ERR_get_error()))
		lacked |= ERR_GET_REASON(error) == ERR_R_MALLOC_FAILURE;
	return lacked;
}
