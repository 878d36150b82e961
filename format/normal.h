/* Octahedral normals (Cigolle et al. 2014, "A survey of efficient representations for independent
 * unit vectors"). Decoding gives a unit vector. */
#ifndef GOPURA_FORMAT_NORMAL_H
#define GOPURA_FORMAT_NORMAL_H

#include <stdint.h>

void normal_encode(int8_t out[2], const float normal[3]);
void normal_decode(float out[3], const int8_t normal[2]);

#endif
