#include <stdlib.h>
#include <string.h>

#include "curator/accounts/accounts.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What was accepted is the same after it was written and read again. */
static void check_again(const struct accounts *accounts)
{
	struct diagnostics diagnostics = { 0 };
	struct accounts again;
	struct buffer text;

	buffer_init(&text, ACCOUNTS_FILE_BYTES_MAX);
	accounts_print(&text, accounts);
	for (uint32_t n = 0; n < accounts->count; n++)
		if (!account_name_is_valid(accounts->list[n].name) ||
		    accounts->list[n].role == ROLE_NONE)
			abort();
	if (accounts_parse(&again, buffer_bytes(&text), &diagnostics) == 0) {
		if (again.count != accounts->count ||
		    (again.count > 0 && memcmp(again.list[0].name, accounts->list[0].name,
					       sizeof(again.list[0].name)) != 0))
			abort();
		accounts_finish(&again);
	} else if (!text.error) {
		abort();
	}
	buffer_finish(&text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct diagnostics diagnostics = { 0 };
	struct accounts accounts;

	if (accounts_parse(&accounts, (struct bytes){ data, size }, &diagnostics) == 0)
		check_again(&accounts);
	else if (accounts.list || diagnostics.count == 0)
		abort();
	accounts_finish(&accounts);
	return 0;
}
