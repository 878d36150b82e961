/* Compares texts line by line, by libgit2: merges two that come from the same one, and shows what
 * differs. */
#ifndef GOPURA_CURATOR_STORE_TEXT_COMPARE_H
#define GOPURA_CURATOR_STORE_TEXT_COMPARE_H

#include <stdbool.h>

#include "base/bytes.h"

/* Appends to *out what both changed of base. *is_clean: they changed different lines. Otherwise the
 * places where both changed something else hold both texts, as
 *   <<<<<<< mine
 *   ...
 *   =======
 *   ...
 *   >>>>>>> theirs
 * so no word of either is lost. -EINVAL: a text is not text (it has a zero byte). -ENOMEM, -EFBIG.
 */
must_check int text_merge(struct buffer *out, struct bytes base, struct bytes mine,
			  struct bytes theirs, bool *is_clean);

/* Appends the lines of both texts, each after ' ' (in both), '-' (in the old one alone), '+' (in
 * the new one alone), or a line "@" where lines of both were left out. Nothing if they are equal.
 * -EINVAL: a text is not text. -ENOMEM, -EFBIG. */
must_check int text_difference(struct buffer *out, struct bytes old, struct bytes new);

#endif
