/* Which side of a photograph is up, as the camera noted it. */
#ifndef GOPURA_CURATOR_PAGES_EXIF_ORIENTATION_H
#define GOPURA_CURATOR_PAGES_EXIF_ORIENTATION_H

#include "base/bytes.h"

/* Returns EXIF's tag 0x0112 of a JPEG, 1 to 8 (EXIF 2.32, 4.6.4); 1 if there is none. */
unsigned exif_orientation(struct bytes jpeg);

#endif
