/* The first view if temple.ini does not give one: from a corner in front (-y), slightly above, as
 * near as possible with the whole box in the picture. Pure. */
#ifndef GOPURA_PIPELINE_CONTENT_START_VIEW_H
#define GOPURA_PIPELINE_CONTENT_START_VIEW_H

/* The picture that the box must fit into, with a margin of a twentieth on each side: the kiosk's
 * field of view, on a panel that is not necessarily wide. */
#define START_VIEW_FOV_DEG 45.0 /* vertical */
#define START_VIEW_ASPECT  (4.0 / 3)

/* Sets eye and target. Metres, z up. A box without extent is viewed from one metre away. */
void start_view(float eye_m[3], float target_m[3], const float box_min_m[3],
		const float box_max_m[3]);

#endif
