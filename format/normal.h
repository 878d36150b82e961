/* Octahedral normals (Cigolle et al. 2014, "A survey of efficient representations for independent
 * unit vectors"). */
#ifndef GOPURA_FORMAT_NORMAL_H
#define GOPURA_FORMAT_NORMAL_H

#include <stdint.h>

/* Encodes a vector of any length. A zero or non-finite vector gives (0, 0), which decodes to +z. */
void normal_encode(int8_t out[2], const float normal[3]);
/* Decodes to a unit vector. Any two bytes are accepted. */
void normal_decode(float out[3], const int8_t normal[2]);

#endif
