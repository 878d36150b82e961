/* Where the signing keys of a content folder are.
 *
 * Not in it: what lies there is made by many hands, and is read by parsers of foreign formats.
 *
 *   --keys FOLDER                               where somebody says so
 *   $XDG_CONFIG_HOME/gopura/keys/NAME[-N]       else; ~/.config where that is not set
 *
 * NAME is the content folder's name. The file `content` in the keys' folder holds the content
 * folder's path, so that two content folders of one name do not share keys: the second gets NAME-2.
 * A keys' folder without that file belongs to the first content folder that asks.
 *
 * Keys were once made in DIR/keys. Such are moved to their new place. */
#ifndef GOPURA_PIPELINE_KEYS_KEYS_PLACE_H
#define GOPURA_PIPELINE_KEYS_KEYS_PLACE_H

#include <limits.h>

#include "pipeline/keys/keys.h"

/* Finds the keys of a content folder, moves or makes them where necessary, and reads them. given is
 * --keys or NULL. folder gets their place; *made tells whether they are new, and may be NULL.
 * Errors are logged; keys_finish after success. */
must_check int keys_open(struct publisher_keys *out, char folder[PATH_MAX],
			 const char *content_folder, const char *given, bool *made);

#endif
