/* Makes the table of marching cubes. */
#include "pipeline/octree/cube_table.h"

#include <pthread.h>
#include <stdbool.h>
#include <string.h>

enum { COST_MAX = 1000 };

static struct cube_case cases[256];
static pthread_once_t once = PTHREAD_ONCE_INIT;

uint8_t cube_edge_corner(int edge)
{
	const int axis = edge / 4, i = edge % 4;

	return (uint8_t)((i & 1) << (axis + 1) % 3 | (i >> 1) << (axis + 2) % 3);
}

int cube_edge_between(int a, int b)
{
	const int bit = a ^ b, axis = bit == 1 ? 0 : bit == 2 ? 1 : 2;
	const int low = a & b;

	return 4 * axis + (low >> (axis + 1) % 3 & 1) + 2 * (low >> (axis + 2) % 3 & 1);
}

void cube_face_corners(int corners[4], int axis, int side)
{
	static const uint8_t round[4] = { 0, 1, 3, 2 };

	for (int i = 0; i < 4; i++) {
		/* the two axes of the face, so that going round is counter-clockwise at side 1 */
		const int at = round[side ? i : 3 - i];

		corners[i] =
			(at & 1) << (axis + 1) % 3 | (at >> 1) << (axis + 2) % 3 | side << axis;
	}
}

int cube_edges_share_face(int a, int b)
{
	const int a_low = cube_edge_corner(a), b_low = cube_edge_corner(b);
	const int a_high = a_low | 1 << a / 4, b_high = b_low | 1 << b / 4;

	for (int k = 0; k < 3; k++)
		for (int side = 0; side < 2; side++)
			if ((a_low >> k & 1) == side && (a_high >> k & 1) == side &&
			    (b_low >> k & 1) == side && (b_high >> k & 1) == side)
				return 1;
	return 0;
}

/* Joins the crossings of one face: for each run of inside corners, the edge where it is entered to
 * the edge where it is left, going round counter-clockwise seen from outside the cube. */
static void join_face(uint8_t next[CUBE_EDGES], int inside, int axis, int side)
{
	int corners[4];

	cube_face_corners(corners, axis, side);
	for (int i = 0; i < 4; i++) {
		int last = i;

		if ((inside >> corners[i] & 1) == 0 || (inside >> corners[(i + 3) % 4] & 1))
			continue;
		while (inside >> corners[(last + 1) % 4] & 1)
			last = (last + 1) % 4;
		next[cube_edge_between(corners[(i + 3) % 4], corners[i])] =
			(uint8_t)cube_edge_between(corners[last], corners[(last + 1) % 4]);
	}
}

/* The triangles of an outline of n edges with the fewest diagonals in a face (dynamic programming
 * over its parts). cost and middle are of the part between two of its edges. */
struct division {
	int cost[CUBE_EDGES][CUBE_EDGES];
	int middle[CUBE_EDGES][CUBE_EDGES];
};

static void divide(struct division *division, const uint8_t *outline, int n)
{
	memset(division, 0, sizeof(*division));
	for (int length = 2; length < n; length++)
		for (int i = 0; i + length < n; i++) {
			const int k = i + length;
			const bool is_side = length == n - 1;

			division->cost[i][k] = COST_MAX;
			for (int m = i + 1; m < k; m++) {
				const int cost = division->cost[i][m] + division->cost[m][k];

				if (cost < division->cost[i][k]) {
					division->cost[i][k] = cost;
					division->middle[i][k] = m;
				}
			}
			if (!is_side)
				division->cost[i][k] +=
					cube_edges_share_face(outline[i], outline[k]);
		}
}

static void add_part(struct cube_case *out, const struct division *division, const uint8_t *outline,
		     int i, int k)
{
	uint8_t *triangle;
	int m;

	if (k - i < 2)
		return;
	m = division->middle[i][k];
	triangle = out->triangles[out->triangle_count++];
	triangle[0] = outline[i];
	triangle[1] = outline[m];
	triangle[2] = outline[k];
	add_part(out, division, outline, i, m);
	add_part(out, division, outline, m, k);
}

static void make_case(struct cube_case *out, int inside)
{
	bool used[CUBE_EDGES] = { false };

	memset(out->next, CUBE_NO_EDGE, sizeof(out->next));
	for (int axis = 0; axis < 3; axis++)
		for (int side = 0; side < 2; side++)
			join_face(out->next, inside, axis, side);
	for (int edge = 0; edge < CUBE_EDGES; edge++) {
		uint8_t outline[CUBE_EDGES];
		struct division division;
		int n = 0;

		if (out->next[edge] == CUBE_NO_EDGE)
			continue;
		for (int at = edge; !used[at]; at = out->next[at]) {
			used[at] = true;
			outline[n++] = (uint8_t)at;
		}
		if (n == 0)
			continue;
		divide(&division, outline, n);
		add_part(out, &division, outline, 0, n - 1);
	}
}

static void make_cases(void)
{
	for (int inside = 0; inside < 256; inside++)
		make_case(&cases[inside], inside);
}

const struct cube_case *cube_case_of(uint8_t inside)
{
	pthread_once(&once, make_cases);
	return &cases[inside];
}
