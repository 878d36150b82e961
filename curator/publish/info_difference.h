/* What differs between the information databases of two releases. */
#ifndef GOPURA_CURATOR_PUBLISH_INFO_DIFFERENCE_H
#define GOPURA_CURATOR_PUBLISH_INFO_DIFFERENCE_H

#include <stdbool.h>

#include "base/bytes.h"

struct cJSON;

/* Adds to *json:
 *
 *   parts, cards, pages, sounds, pictures, tours   [{"key", "title", "change"}], change being
 * added, changed or removed; the key of a card, page or sound is "PART.LANGUAGE" picture_bytes   of
 * pictures that are added or changed sound_bytes     the same of spoken texts; missing if there are
 * none languages       [{"code", "titles", "pages"}]: how many are missing
 *
 * before empty: there was no release. Both are images that gopura-content made. -EBADMSG: one is
 * not; -ENOMEM. */
must_check int info_difference(struct cJSON *json, struct bytes now, struct bytes before);

#endif
