/* The texts about the parts of the model, as copies. */
#ifndef GOPURA_UI_PARTS_H
#define GOPURA_UI_PARTS_H

#include <stdint.h>

#include "base/compiler.h"
#include "ui/overlay_data.h"

struct parts {
	struct overlay_part *list; /* owned, and so are its texts; in order of importance */
	uint32_t count;
};

/* Returns -ENOMEM; *out is then empty. */
must_check int parts_copy(struct parts *out, const struct overlay_part *parts, uint32_t count);
void parts_free(struct parts *parts); /* zeroed is fine */

#endif
