/* Turns as unit quaternions x y z w, as glTF has them; x y z is the axis times the sine of half the
 * angle. Pure functions on plain values. */
#ifndef GOPURA_GEOMETRY_TURN_H
#define GOPURA_GEOMETRY_TURN_H

/* Sets out to the turn about an axis of any length; an axis of length 0 turns nothing. */
void turn_about(float out[4], const float axis[3], float angle_rad);
/* Sets out to what first does, and then what second does. */
void turn_twice(float out[4], const float first[4], const float second[4]);
/* Sets out to the turn at a share of the shorter way from a to b, at an even speed. */
void turn_between(float out[4], const float a[4], const float b[4], float share);
/* Sets out, which may be v, to where a turn brings a vector. */
void turn_vector(float out[3], const float turn[4], const float v[3]);
/* Sets the upper left of a column-major matrix to a turn; the rest stays. */
void turn_matrix(float m[16], const float turn[4]);

#endif
