/* What the app gives the overlay: plain data that the overlay passes to its views. */
#ifndef GOPURA_UI_OVERLAY_DATA_H
#define GOPURA_UI_OVERLAY_DATA_H

#include <stdbool.h>

enum {
	OVERLAY_PARTS_MAX = 1000,
	OVERLAY_LANGUAGES_MAX = 64,
	OVERLAY_TOURS_MAX = 8,
	OVERLAY_DISC_COUNT = 2, /* tools with a disc, the first ones */
	OVERLAY_CHOICES_MAX = 8,
	OVERLAY_CHOICE_BYTES = 128, /* of a title, with its end */
};

struct overlay_part {
	const char *title, *caption; /* UTF-8; caption may be "" */
	const char *thumbnail;       /* a picture's name, or "" */
	bool has_page;
};

/* The current position of a part's anchor on the panel. */
struct overlay_anchor {
	float x_px, y_px;
	float size_px; /* size of the part on the panel; 0: a place without a size */
	bool visible;  /* in front of the camera and inside the scene's rectangle */
	bool hidden;   /* behind the model: its callout dims, and goes if this lasts */
};

struct overlay_tour {
	const char *title, *caption; /* caption may be "" */
	const char *thumbnail;       /* a picture's name, or "" */
};

/* Where the tour is that runs. */
struct overlay_tour_state {
	int tour, stop, stop_count; /* only stops at which the tour stays are counted */
	const char *caption;
	bool paused;
};

/* A spoken text that is heard. */
struct overlay_spoken {
	const char *words; /* that are said now; "": not known, or a pause */
	float share;       /* of the text that was heard, 0..1 */
};

/* Viewing tools that the content offers to visitors, one bit each: docs/tools.md. */
enum overlay_tool {
	OVERLAY_TOOL_LIGHT = 1,
	OVERLAY_TOOL_SECTION = 2,
	OVERLAY_TOOL_MEASURE = 4,
	OVERLAY_TOOL_WALK = 8,
};

/* What is measured from point to point. */
struct overlay_measure {
	unsigned count;   /* of ends that are set: 0 to 2 */
	bool in_sight[2]; /* whether each end is in front of the camera and in the scene */
	float at_px[2][2];
	float length_m, error_m; /* with two ends */
};

/* State of the tools. Directions are relative to the disc of the tool: the ring has radius 1, up
 * points away from the viewer. */
struct overlay_tools {
	/* mask of enum overlay_tool */
	unsigned on;
	float light_at[2]; /* right, up */
	float turn_rad;    /* direction of the part cut away, from up to the left */
	float push;        /* offset of the cut in that direction; 1 and -1 at the ring */
	struct overlay_measure measure;
	bool no_way; /* no way on foot leads to what was touched last */
};

/* Settings of one visitor; they are reset for the next one. */
struct overlay_comfort {
	bool large; /* large type, THEME_LARGE_TYPE times as large */
	bool reach; /* all controls are in the lower third, for seated or small visitors */
};

#endif
