/* Where the signing keys of a content folder are.
 *
 * They are not in the content folder, because many people edit it, and parsers of foreign formats
 * read it.
 *
 *   --keys FOLDER                               if given
 *   $XDG_CONFIG_HOME/gopura/keys/NAME[-N]       otherwise; ~/.config if the variable is not set
 *
 * NAME is the name of the content folder. The file `content` in the keys' folder holds the path of
 * the content folder, so that two content folders of the same name do not share keys: the second
 * one gets NAME-2. A keys' folder without that file belongs to the first content folder that asks.
 *
 * Earlier programs created keys in DIR/keys. Such keys are moved to the new place. */
#ifndef GOPURA_PIPELINE_KEYS_KEYS_PLACE_H
#define GOPURA_PIPELINE_KEYS_KEYS_PLACE_H

#include <limits.h>

#include "pipeline/keys/keys.h"

/* Finds the keys of a content folder (NULL: of none, and `given` says where they are), moves or
 * creates them if necessary, and reads them. out NULL: finds their folder alone, for a museum that
 * signs with other keys (signing.ini). `given` is the value of --keys, or NULL. `folder` gets their
 * place. *made says whether they are new; it may be NULL. Negative errno; errors are logged. Call
 * keys_finish after success. */
must_check int keys_open(struct publisher_keys *out, char folder[PATH_MAX],
			 const char *content_folder, const char *given, bool *made);

#endif
