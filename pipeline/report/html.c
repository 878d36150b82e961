/* Escaping, units and data in the page. */
#include "pipeline/report/html.h"

#include <inttypes.h>
#include <math.h>

#include <sodium.h>

void html_text(FILE *to, const char *text)
{
	for (; *text; text++) {
		switch (*text) {
		case '&':
			fputs("&amp;", to);
			break;
		case '<':
			fputs("&lt;", to);
			break;
		case '>':
			fputs("&gt;", to);
			break;
		case '"':
			fputs("&quot;", to);
			break;
		case '\'':
			fputs("&#39;", to);
			break;
		default:
			fputc((unsigned char)*text < ' ' ? ' ' : *text, to);
		}
	}
}

void html_count(FILE *to, uint64_t count)
{
	if (count >= 1000) {
		html_count(to, count / 1000);
		fprintf(to, "&#8239;%03u", (unsigned)(count % 1000));
	} else {
		fprintf(to, "%u", (unsigned)count);
	}
}

void html_bytes(FILE *to, uint64_t bytes)
{
	static const char *const units[] = { "B", "kB", "MB", "GB", "TB" };
	double value = (double)bytes;
	int unit = 0;

	for (; value >= 1000 && unit < 4; unit++)
		value /= 1000;
	fprintf(to, "%.*f&#8239;%s", unit > 0 && value < 10 ? 1 : 0, value, units[unit]);
}

void html_length(FILE *to, double metres)
{
	if (metres <= 0)
		fputc('0', to);
	else if (metres >= 1)
		fprintf(to, "%.2f&#8239;m", metres);
	else if (metres >= 0.1)
		fprintf(to, "%.0f&#8239;cm", metres * 100);
	else if (metres >= 0.001)
		fprintf(to, "%.1f&#8239;mm", metres * 1000);
	else
		fprintf(to, "%.3f&#8239;mm", metres * 1000);
}

void html_time(FILE *to, int64_t ms)
{
	double seconds = (double)ms / 1000;

	if (seconds < 100)
		fprintf(to, "%.1f&#8239;s", seconds);
	else if (seconds < 6000)
		fprintf(to, "%.1f&#8239;min", seconds / 60);
	else
		fprintf(to, "%.1f&#8239;h", seconds / 3600);
}

void html_data(FILE *to, const char *type, struct bytes file)
{
	enum { PIECE = 3 * 1024 }; /* a multiple of 3 ends without padding */
	char text[sodium_base64_ENCODED_LEN(PIECE, sodium_base64_VARIANT_ORIGINAL)];

	fprintf(to, "data:%s;base64,", type);
	for (size_t at = 0; at < file.size; at += PIECE) {
		size_t size = file.size - at < PIECE ? file.size - at : PIECE;

		fputs(sodium_bin2base64(text, sizeof(text), file.data + at, size,
					sodium_base64_VARIANT_ORIGINAL),
		      to);
	}
}

void html_bar(FILE *to, double share)
{
	fprintf(to, "<td class=\"bar\" style=\"--share:%.1f%%\">", 100 * fmin(1, fmax(0, share)));
}

void html_bar_end(FILE *to)
{
	fputs("</td>", to);
}
