/* Where the visitor begins where temple.ini does not say: from a corner in front (-y), a little
 * above, as near as leaves the whole box in the picture. Pure. */
#ifndef GOPURA_PIPELINE_RELEASE_START_VIEW_H
#define GOPURA_PIPELINE_RELEASE_START_VIEW_H

/* The picture that the box fits into, with a twentieth to spare on each side: the kiosk's field of
 * view, on a panel that need not be wide. */
#define START_VIEW_FOV_DEG 45.0 /* vertical */
#define START_VIEW_ASPECT  (4.0 / 3)

/* Metres, z up. A box without extent is looked at from a metre away. */
void start_view(float eye_m[3], float target_m[3], const float box_min_m[3],
		const float box_max_m[3]);

#endif
