/* Two pages that two curators send, and the one that both began from, with lines "====" between
 * them: merged and compared as when they are saved. */
#include <errno.h>
#include <git2.h>
#include <stdlib.h>
#include <string.h>

#include "curator/store/text_compare.h"

enum { TEXTS = 3, OUT_BYTES_MAX = 4 << 20 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static bool is_equal(const struct buffer *out, struct bytes text)
{
	return out->size == text.size &&
	       (text.size == 0 || memcmp(out->data, text.data, text.size) == 0);
}

static void split(struct bytes texts[TEXTS], const uint8_t *data, size_t size)
{
	static const char mark[] = "====\n";

	for (int n = 0; n < TEXTS; n++) {
		const uint8_t *at = size > 0 && n + 1 < TEXTS
					    ? memmem(data, size, mark, sizeof(mark) - 1)
					    : NULL;
		const size_t bytes = at ? (size_t)(at - data) : size;

		texts[n] = (struct bytes){ data, bytes };
		data += bytes + (at ? sizeof(mark) - 1 : 0);
		size -= bytes + (at ? sizeof(mark) - 1 : 0);
	}
}

/* Where only one has changed something, that one's text is the result. */
static void merge_alone(struct bytes base, struct bytes mine)
{
	struct buffer out;
	bool is_clean;

	buffer_init(&out, OUT_BYTES_MAX);
	if (text_merge(&out, base, mine, base, &is_clean) == 0 &&
	    (!is_clean || !is_equal(&out, mine)))
		abort();
	buffer_finish(&out);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static bool is_ready; /* as in the program, where a history is open */
	struct bytes texts[TEXTS];
	struct buffer out;
	bool is_clean;
	int rc;

	if (!is_ready)
		is_ready = git_libgit2_init() > 0;
	split(texts, data, size);
	buffer_init(&out, OUT_BYTES_MAX);
	rc = text_merge(&out, texts[0], texts[1], texts[2], &is_clean);
	if (rc != 0 && rc != -EINVAL && rc != -EFBIG && rc != -ENOMEM)
		abort();
	buffer_clear(&out);
	rc = text_difference(&out, texts[1], texts[1]);
	if (rc == 0 && out.size > 0)
		abort();
	buffer_clear(&out);
	(void)!text_difference(&out, texts[1], texts[2]);
	buffer_finish(&out);
	merge_alone(texts[0], texts[1]);
	return 0;
}
