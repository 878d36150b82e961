/* What a visitor holds of the tools that the content gives: a raking light and a section.
 * docs/tools.md. */
#ifndef GOPURA_APP_TOOLS_H
#define GOPURA_APP_TOOLS_H

#include "render/scene.h"
#include "ui/overlay.h"

enum { TOOLS_CONTACT_NONE = -1 };

struct tools {
	struct scene_tools now;
	enum overlay_handle held; /* by the one finger that may */
	int contact;              /* which that is */
	float grabbed_at[2];      /* where on the disc it came down */
	float grabbed_push_m;
};

#endif
