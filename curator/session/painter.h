/* The pictures of a session: fast ones while the eye moves, a sharp one at rest, each with the
 * region in another colour. The sharp view is kept for the tools. One thread. */
#ifndef GOPURA_CURATOR_SESSION_PAINTER_H
#define GOPURA_CURATOR_SESSION_PAINTER_H

#include "base/bytes.h"
#include "curator/region/region_set.h"
#include "curator/select/view_image.h"
#include "curator/session/site.h"
#include "geometry/camera.h"

/* Sides of a picture; even. */
enum { PAINTER_SIDE_MIN_PX = 64, PAINTER_SIDE_MAX_PX = 2048 };

struct painter;

/* site and set are borrowed for the lifetime of *out, which the caller owns; NULL on failure.
 * -ENOMEM. */
must_check int painter_create(struct painter **out, struct site *site,
			      const struct region_set *set);
void painter_destroy(struct painter *painter); /* NULL is fine */

/* Draws a view, sharp or, of half the size and with less detail, fast, and appends its JPEG to
 * *out. The camera has the size of the sharp picture. -ENOMEM, -EBADMSG if the master is damaged,
 * or an error of the disk. */
must_check int painter_draw(struct painter *painter, const struct camera *camera, bool sharp,
			    struct buffer *out);
/* Appends the last sharp view again, with the region as it is now. Errors likewise. */
must_check int painter_draw_again(struct painter *painter, struct buffer *out);

/* Draws one more of the views whose mean is the last sharp view without steps at its edges. Returns
 * 1: there are more to draw; 0: that was the last one, and the mean's JPEG is appended; the next
 * call begins anew. painter_draw of a sharp view and painter_draw_again begin anew too. Errors as
 * of painter_draw; -EINVAL: there is no sharp view. */
must_check int painter_smooth(struct painter *painter, struct buffer *out);

/* Returns the last sharp view, borrowed until the next painter_draw of a sharp one; NULL: there is
 * none. */
const struct view_image *painter_view(const struct painter *painter, struct camera *camera);

#endif
