/* What differs between the information databases of two releases. */
#ifndef GOPURA_CURATOR_PUBLISH_INFO_DIFFERENCE_H
#define GOPURA_CURATOR_PUBLISH_INFO_DIFFERENCE_H

#include <stdbool.h>

#include "base/bytes.h"

struct cJSON;

/* Adds to *json lists of what differs, one each for parts, cards, pages, sounds, pictures and
 * tours:
 * [{"key", "title", "change"}]. change is added, changed or removed; the key of a card, page or
 * sound is "PART.LANGUAGE".
 *
 * Also picture_bytes, those of pictures that are added or changed; sound_bytes, the same of spoken
 * texts, if there are any; and languages, [{"code", "titles", "pages"}]: how many are missing in
 * each.
 *
 * before empty: there was no release. Both are images that gopura-content made. -EBADMSG: one is
 * not; -ENOMEM. */
must_check int info_difference(struct cJSON *json, struct bytes now, struct bytes before);

#endif
