/* Encodes, decodes and checks the payload of the root page. */
#include "format/root_page.h"

#include <errno.h>
#include <math.h>

enum { HAS_STREAM = 1, HAS_SCENERY = 2, HAS_SOLID = 4, CUT = 8 };

void lattice_fit(struct lattice *lattice, const float box_min_m[3], const float box_max_m[3])
{
	double longest = 0;

	for (int axis = 0; axis < 3; axis++)
		longest = fmax(longest, (double)box_max_m[axis] - box_min_m[axis]);
	lattice->fine_bits = 0;
	while (lattice->fine_bits < LATTICE_FINE_BITS_MAX &&
	       longest / lattice->step_m > (1 << (LATTICE_BITS + lattice->fine_bits)) - 0.5)
		lattice->fine_bits++;
}

static void put_vector(struct buffer *out, const float vector[3])
{
	for (int axis = 0; axis < 3; axis++)
		buffer_put_f32(out, vector[axis]);
}

void root_page_encode(struct buffer *out, const struct root_page *root)
{
	buffer_put_string(out, root->name);
	for (int axis = 0; axis < 3; axis++)
		buffer_put_f64(out, root->lattice.origin_m[axis]);
	buffer_put_f64(out, root->lattice.step_m);
	put_vector(out, root->box_min_m);
	put_vector(out, root->box_max_m);
	put_vector(out, root->start_eye_m);
	put_vector(out, root->start_target_m);
	put_vector(out, root->sun);
	buffer_put_u8(out, root->lit);
	buffer_put(out, root->background, sizeof(root->background));
	buffer_put_u64(out, root->source_triangles);
	buffer_put_u64(out, root->published_triangles);
	if (root->has_stream || root->has_scenery || root->has_solid || root->cut)
		buffer_put_u8(out, (uint8_t)(root->has_stream * HAS_STREAM +
					     root->has_scenery * HAS_SCENERY +
					     root->has_solid * HAS_SOLID + root->cut * CUT));
}

static bool read_vector(struct reader *reader, float vector[3])
{
	bool finite = true;

	for (int axis = 0; axis < 3; axis++) {
		vector[axis] = reader_f32(reader);
		finite = finite && isfinite(vector[axis]);
	}
	return finite;
}

static bool read_lattice(struct reader *reader, struct lattice *lattice)
{
	bool finite = true;

	for (int axis = 0; axis < 3; axis++) {
		lattice->origin_m[axis] = reader_f64(reader);
		finite = finite && isfinite(lattice->origin_m[axis]);
	}
	lattice->step_m = reader_f64(reader);
	return finite && isfinite(lattice->step_m) && lattice->step_m > 0;
}

static bool is_sane(const struct root_page *root)
{
	double sun = 0;

	for (int axis = 0; axis < 3; axis++) {
		sun += (double)root->sun[axis] * root->sun[axis];
		if (root->box_min_m[axis] > root->box_max_m[axis])
			return false;
	}
	return fabs(sun - 1) < 1e-3 && root->lit <= 1 && root->cut <= ROOT_CUT_MAX &&
	       root->source_triangles > 0 && root->name[0] != '\0';
}

int root_page_decode(struct root_page *out, struct bytes payload)
{
	struct root_page root = { 0 };
	struct reader reader;
	bool good;

	*out = root;
	reader_init(&reader, payload);
	reader_string(&reader, root.name, sizeof(root.name));
	good = read_lattice(&reader, &root.lattice);
	good = read_vector(&reader, root.box_min_m) && good;
	good = read_vector(&reader, root.box_max_m) && good;
	good = read_vector(&reader, root.start_eye_m) && good;
	good = read_vector(&reader, root.start_target_m) && good;
	good = read_vector(&reader, root.sun) && good;
	root.lit = reader_u8(&reader);
	for (int channel = 0; channel < 3; channel++)
		root.background[channel] = reader_u8(&reader);
	root.source_triangles = reader_u64(&reader);
	root.published_triangles = reader_u64(&reader);
	if (!reader.failed && reader_left(&reader) > 0) {
		const uint8_t more = reader_u8(&reader);

		root.has_stream = (more & HAS_STREAM) != 0;
		root.has_scenery = (more & HAS_SCENERY) != 0;
		root.has_solid = (more & HAS_SOLID) != 0;
		root.cut = more / CUT;
		good = good && more > 0;
	}
	if (reader.failed || reader_left(&reader) > 0 || !good || !is_sane(&root))
		return -EBADMSG;
	lattice_fit(&root.lattice, root.box_min_m, root.box_max_m);
	*out = root;
	return 0;
}
