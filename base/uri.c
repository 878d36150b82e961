/* Decodes the bytes that an address has in hexadecimal. */
#include "base/uri.h"

static int hex_digit(char c)
{
	return c >= '0' && c <= '9'   ? c - '0'
	       : c >= 'a' && c <= 'f' ? c - 'a' + 10
	       : c >= 'A' && c <= 'F' ? c - 'A' + 10
				      : -1;
}

bool uri_decode(char *out, size_t room, const char *uri)
{
	size_t size = 0;

	for (; *uri && size + 1 < room; uri++) {
		const int high = *uri == '%' ? hex_digit(uri[1]) : -1;
		const int low = high >= 0 ? hex_digit(uri[2]) : -1;
		const bool is_byte = low >= 0 && high * 16 + low > 0;

		out[size++] = is_byte ? (char)(high * 16 + low) : *uri;
		if (is_byte)
			uri += 2;
	}
	out[size] = '\0';
	return !*uri;
}
