/* Writes the page: a section for each stage. The style is in the page, and there are no scripts. */
#include "pipeline/report/report.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "geometry/vec.h"
#include "pipeline/report/html.h"
#include "pipeline/report/report_data.h"
#include "pipeline/samples/sampler.h"
#include "storage/info.h"

static const char style[] =
	":root{color-scheme:light dark;--ink:#22262b;--quiet:#66707c;--paper:#f6f4ef;--card:#fff;"
	"--line:#e2ddd2;--bar:#e9dfc8;--accent:#9a5b1e;--seen:#c98a3b;--border:#d8423a;"
	"--crowded:#8a3fd1;--turned:#1f7fd0}"
	"@media(prefers-color-scheme:dark){:root{--ink:#e8e4dc;--quiet:#9aa3ad;--paper:#15181c;"
	"--card:#1e2227;--line:#343a42;--bar:#47391f;--accent:#e3a75f;--seen:#e3a75f;"
	"--border:#ff7a70;--crowded:#c08bff;--turned:#6cb8ff}}"
	"*{box-sizing:border-box}"
	"body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.5 system-ui,sans-serif}"
	"main{max-width:1080px;margin:0 auto;padding:28px 20px 60px}"
	"h1{font-size:2.1rem;line-height:1.2;margin:0 0 4px;font-weight:650}"
	"h2{font-size:1.25rem;margin:44px 0 6px;font-weight:650}"
	"p{margin:0 0 14px;max-width:70ch;color:var(--quiet)}"
	".facts{display:grid;grid-template-columns:repeat(auto-fit,minmax(150px,1fr));gap:12px;"
	"margin:24px 0}"
	".facts div,.card{background:var(--card);border:1px solid var(--line);border-radius:10px;"
	"padding:12px 16px}"
	".facts b{display:block;font-size:1.5rem;line-height:1.25;font-weight:600;"
	"font-variant-numeric:tabular-nums}.facts span{color:var(--quiet);font-size:.9rem}"
	".two{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,420px),1fr));"
	"gap:16px;align-items:start}"
	"figure{margin:0}figcaption{color:var(--quiet);font-size:.9rem;margin-top:6px}"
	"img,svg{display:block;width:100%;height:auto}.picture{border-radius:10px}"
	"svg.picture{background-size:100% 100%}"
	".scroll{overflow-x:auto}table{border-collapse:collapse;width:100%;"
	"font-variant-numeric:tabular-nums}"
	"th,td{text-align:right;padding:6px 10px;border-bottom:1px solid var(--line);"
	"white-space:nowrap}th{color:var(--quiet);font-weight:500;font-size:.9rem}"
	"th:first-child,td:first-child,.left{text-align:left}"
	"td:first-child{white-space:normal;min-width:9em}"
	"tr:last-child td{border-bottom:0}"
	".bar{background:linear-gradient(to left,var(--bar) var(--share),transparent 0)}"
	".key{display:inline-block;width:.8em;height:.8em;border-radius:50%;margin-right:.4em}"
	".thumbs{display:grid;grid-template-columns:repeat(auto-fill,minmax(100px,1fr));gap:10px}"
	".thumbs img{border-radius:6px}"
	".stack{display:flex;height:26px;border-radius:6px;overflow:hidden;margin:12px 0}"
	".stack i{display:block;min-width:1px}"
	".stack i:nth-child(4n+1),tr:nth-child(4n+1) .key.of{background:#c98a3b}"
	".stack i:nth-child(4n+2),tr:nth-child(4n+2) .key.of{background:#5b8c7b}"
	".stack i:nth-child(4n+3),tr:nth-child(4n+3) .key.of{background:#6f7fb2}"
	".stack i:nth-child(4n+4),tr:nth-child(4n+4) .key.of{background:#a86a86}"
	".good{color:#3f8f5f}";

static void begin_section(FILE *to, const char *title, const char *text)
{
	fprintf(to, "<section><h2>%s</h2><p>%s</p>\n", title, text);
}

/* ---- the head */

static void put_fact_begin(FILE *to)
{
	fputs("<div><b>", to);
}

static void put_fact_end(FILE *to, const char *text)
{
	fprintf(to, "</b><span>%s</span></div>\n", text);
}

static void put_count(FILE *to, uint64_t count, const char *text)
{
	put_fact_begin(to);
	html_count(to, count);
	put_fact_end(to, text);
}

/* Names a picture that the style draws behind marks; one that could not be drawn is left out. */
static void put_background(FILE *to, const char *name, const struct buffer *picture)
{
	if (picture->size == 0)
		return;
	fprintf(to, ".%s{background-image:url(", name);
	html_data(to, "image/jpeg", buffer_bytes(picture));
	fputs(")}\n", to);
}

static void put_head(FILE *to, const struct report_data *data)
{
	fputs("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
	      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>",
	      to);
	html_text(to, data->content->name);
	fprintf(to, ": report of the build</title>\n<style>%s\n", style);
	put_background(to, "above", &data->pictures[REPORT_ABOVE]);
	put_background(to, "front", &data->pictures[REPORT_MODEL]);
	fputs("</style></head>\n<body><main>\n<h1>", to);
	html_text(to, data->content->name);
	fprintf(to, "</h1><p>Release %" PRIu64 ". What its build found, made and cost.</p>\n",
		data->options->publish->publish.release.sequence);
}

static void put_facts(FILE *to, const struct report_data *data)
{
	const struct publish_content_report *publish = data->options->publish;
	const struct sample_grid *grid = samples_store_grid(data->store);
	int64_t processor_us = 0, all_ms = 0;

	for (uint32_t i = 0; i < data->options->stage_count; i++) {
		all_ms += data->options->stages[i].ms;
		processor_us += data->options->stages[i].processor_us;
	}
	fputs("<div class=\"facts\">\n", to);
	put_count(to, data->master->source_triangles, "triangles in the scan");
	put_fact_begin(to);
	html_count(to, publish->published_triangles);
	fprintf(to, "</b><span>triangles published, %.1f&#8239;%%</span></div>\n",
		100 * (double)publish->published_triangles /
			(double)data->master->source_triangles);
	put_count(to, sample_grid_points(grid), "sampling points");
	put_fact_begin(to);
	html_bytes(to, publish->release_bytes);
	put_fact_end(to, "release");
	put_fact_begin(to);
	html_time(to, all_ms);
	put_fact_end(to, "time of this build");
	put_fact_begin(to);
	html_time(to, processor_us / 1000);
	put_fact_end(to, "processor time");
	fputs("</div>\n", to);
}

static void put_pictures(FILE *to, const struct report_data *data)
{
	if (data->pictures[REPORT_MODEL].size == 0)
		return;
	fprintf(to,
		"<div class=\"two\"><figure><svg class=\"picture front\" viewBox=\"0 0 %d %d\" "
		"role=\"img\" aria-label=\"The model\"></svg><figcaption>The model from its first "
		"view</figcaption></figure>\n<figure><img class=\"picture\" "
		"alt=\"The patches in colours\" src=\"",
		REPORT_PICTURE_WIDTH_PX, REPORT_PICTURE_HEIGHT_PX);
	html_data(to, "image/jpeg", buffer_bytes(&data->pictures[REPORT_PATCHES]));
	fputs("\"><figcaption>The patches drawn for this view, a colour each</figcaption>"
	      "</figure></div>\n",
	      to);
}

/* ---- the scan */

/* A row of the table of repairs: the sum over all scans. */
struct repair_row {
	const char *name, *done;
	size_t offset; /* in struct mesh_repairs */
	int fault;     /* whose places are marked; -1: none */
};

static const struct repair_row repair_rows[] = {
	{ "Faces with a corner that is not a number", "dropped",
	  offsetof(struct mesh_repairs, lost_faces), -1 },
	{ "Faces without area", "dropped", offsetof(struct mesh_repairs, degenerate_faces), -1 },
	{ "Duplicate vertices", "merged", offsetof(struct mesh_repairs, merged_vertices), -1 },
	{ "Vertices without a face", "removed", offsetof(struct mesh_repairs, unused_vertices),
	  -1 },
	{ "Faces that showed the wrong side", "turned", offsetof(struct mesh_repairs, turned_faces),
	  -1 },
	{ "Border edges: the scan is open there", "kept",
	  offsetof(struct mesh_repairs, border_edges), MESH_FAULT_BORDER },
	{ "Edges of three faces or more", "kept", offsetof(struct mesh_repairs, non_manifold_edges),
	  MESH_FAULT_NON_MANIFOLD },
	{ "Edges whose faces show opposite sides", "kept",
	  offsetof(struct mesh_repairs, turned_edges), MESH_FAULT_TURNED },
};

static const char *const fault_colours[MESH_FAULTS] = { "var(--border)", "var(--crowded)",
							"var(--turned)" };

static void put_scans(FILE *to, const struct report_data *data)
{
	fputs("<div class=\"scroll card\"><table><tr><th>scan</th><th>format</th><th>file</th>"
	      "<th>triangles</th><th>vertices</th><th>colours</th></tr>\n",
	      to);
	for (uint32_t i = 0; i < data->import_count; i++) {
		const struct import_report *import = &data->imports[i];

		fputs("<tr><td>", to);
		html_text(to, data->content->scans[i] + strlen(data->content->folder) + 1);
		fprintf(to, "</td><td>%s</td><td>", import->format);
		html_bytes(to, import->file_bytes);
		fputs("</td><td>", to);
		html_count(to, import->triangles);
		fputs("</td><td>", to);
		html_count(to, import->vertices);
		fprintf(to, "</td><td>%s</td></tr>\n",
			import->textures      ? "pictures"
			: import->had_colours ? "of its vertices"
					      : "one for all");
	}
	fputs("</table></div>\n", to);
}

static uint64_t sum_repairs(const struct report_data *data, size_t offset)
{
	uint64_t sum = 0;

	for (uint32_t i = 0; i < data->import_count; i++) {
		uint32_t count;

		memcpy(&count, (const char *)&data->imports[i].repairs + offset, sizeof(count));
		sum += count;
	}
	return sum;
}

static void put_repairs(FILE *to, const struct report_data *data)
{
	uint64_t all = 0;

	fputs("<div class=\"scroll card\"><table><tr><th>found</th><th>number</th>"
	      "<th class=\"left\">and then</th></tr>\n",
	      to);
	for (size_t i = 0; i < ARRAY_COUNT(repair_rows); i++) {
		uint64_t count = sum_repairs(data, repair_rows[i].offset);

		all += count;
		if (count == 0)
			continue;
		fputs("<tr><td>", to);
		if (repair_rows[i].fault >= 0)
			fprintf(to, "<span class=\"key\" style=\"background:%s\"></span>",
				fault_colours[repair_rows[i].fault]);
		fprintf(to, "%s</td><td>", repair_rows[i].name);
		html_count(to, count);
		fprintf(to, "</td><td class=\"left\">%s</td></tr>\n", repair_rows[i].done);
	}
	if (all == 0)
		fputs("<tr><td class=\"good\">Nothing: the scan is closed and clean</td><td></td>"
		      "<td></td></tr>\n",
		      to);
	fputs("</table></div>\n", to);
}

/* Marks the places of faults on the picture, also those behind the model. */
static void put_fault_places(FILE *to, const struct report_data *data)
{
	const struct camera *camera = &data->portraits[REPORT_MODEL].camera;
	uint32_t count = 0, step = 1;

	for (uint32_t i = 0; i < data->import_count; i++) {
		count += data->imports[i].repairs.place_count;
		if (data->imports[i].repairs.place_step > step)
			step = data->imports[i].repairs.place_step;
	}
	if (count == 0 || data->pictures[REPORT_MODEL].size == 0)
		return;
	fprintf(to,
		"<figure><svg class=\"picture front\" viewBox=\"0 0 %d %d\" role=\"img\" "
		"aria-label=\"Where the scan has faults\">\n",
		camera->width_px, camera->height_px);
	for (uint32_t i = 0; i < data->import_count; i++) {
		const struct mesh_repairs *repairs = &data->imports[i].repairs;

		for (uint32_t p = 0; p < repairs->place_count; p++) {
			float x, y;

			if (!camera_pixel(camera, repairs->places[p].place_m, &x, &y))
				continue;
			fprintf(to,
				"<circle cx=\"%.0f\" cy=\"%.0f\" r=\"3.5\" fill=\"%s\" "
				"fill-opacity=\".75\"/>",
				(double)x, (double)y, fault_colours[repairs->places[p].kind]);
		}
	}
	fputs("</svg><figcaption>Where they are, also those behind the model", to);
	if (step > 1)
		fprintf(to, "; one mark for up to %" PRIu32 " edges", step);
	fputs("</figcaption></figure>\n", to);
}

static void put_scan_section(FILE *to, const struct report_data *data)
{
	begin_section(to, "The scan",
		      "What the import read, and what it found that a scan should not have.");
	if (data->import_count == 0) {
		fputs("<p>The counts are not known: the scan was imported by an earlier version. "
		      "Delete .work/mesh and build again.</p></section>\n",
		      to);
		return;
	}
	put_scans(to, data);
	fputs("<div class=\"two\" style=\"margin-top:16px\">\n", to);
	put_repairs(to, data);
	put_fault_places(to, data);
	fputs("</div></section>\n", to);
}

/* ---- the hierarchy */

static void put_levels(FILE *to, const struct report_data *data)
{
	uint64_t most = 1;

	begin_section(
		to, "Levels of detail",
		"From the finest level, which is the scan, each coarser one has about a quarter "
		"of the triangles. The error says how far the surface may lie from the scan "
		"where that level is drawn: in the mean over its pieces, and at most.");
	for (uint32_t i = 0; i < data->level_count; i++)
		if (data->levels[i].triangle_count > most)
			most = data->levels[i].triangle_count;
	fputs("<div class=\"scroll card\"><table><tr><th>level</th><th>triangles</th>"
	      "<th>patches</th><th>groups</th><th>mean error</th><th>largest</th>"
	      "<th>bytes at home</th>"
	      "<th>published</th></tr>\n",
	      to);
	for (uint32_t n = data->level_count; n-- > 0;) {
		const struct report_level *level = &data->levels[n];

		fprintf(to, "<tr><td>%" PRIu32 "%s</td>", n,
			n + 1 == data->level_count ? " (the scan)" : "");
		html_bar(to, (double)level->triangle_count / (double)most);
		html_count(to, level->triangle_count);
		html_bar_end(to);
		fputs("<td>", to);
		html_count(to, level->patch_count);
		fputs("</td><td>", to);
		html_count(to, level->group_count);
		fputs("</td><td>", to);
		html_length(to, level->mean_error_m);
		fputs("</td><td>", to);
		html_length(to, level->error_m);
		fputs("</td><td>", to);
		html_bytes(to, level->bytes);
		fprintf(to, "</td><td>%.0f&#8239;%%</td></tr>\n",
			100.0 * level->published_group_count / level->group_count);
	}
	fputs("</table></div></section>\n", to);
}

/* ---- the samples */

enum { POINT_RADIUS = 13 };

/* How much of a face shows something: the share of its 16 cells. */
static double coverage_of(const struct report_face *face)
{
	return face ? __builtin_popcount(face->coverage) / 16.0 : 0;
}

static void put_point_name(FILE *to, const struct report_data *data, const uint32_t point[3])
{
	if (sample_grid_vantage(samples_store_grid(data->store), point) >= 0)
		fputs("first view", to);
	else
		fprintf(to, "%u, %u, %u", point[0], point[1], point[2]);
}

/* The faces of a point, NULL where nothing shows. */
struct point_faces {
	const struct report_face *of[CUBE_FACES];
	uint64_t bytes;
};

static struct point_faces faces_of(const struct report_data *data, const uint32_t point[3])
{
	const uint32_t *at = data->face_at[report_data_point(data, point)];
	struct point_faces faces = { .bytes = 0 };

	for (int face = 0; face < CUBE_FACES; face++) {
		if (at[face] == 0)
			continue;
		faces.of[face] = &data->faces[at[face] - 1];
		faces.bytes += faces.of[face]->bytes;
	}
	return faces;
}

/* Four wedges for the sides, a dot for below, a ring for above. */
static void put_glyph(FILE *to, float x, float y, const struct point_faces *faces)
{
	static const int ways[4][2] = { { 1, 0 }, { -1, 0 }, { 0, -1 }, { 0, 1 } };

	for (int face = 0; face < 4; face++) {
		const int *way = ways[face];
		double r = POINT_RADIUS, w = r * 0.6;

		fprintf(to,
			"<path d=\"M%.0f %.0fL%.1f %.1fL%.1f %.1fZ\" fill=\"var(--seen)\" "
			"fill-opacity=\"%.2f\"/>",
			(double)x, (double)y, x + way[0] * r - way[1] * w,
			y + way[1] * r - way[0] * w, x + way[0] * r + way[1] * w,
			y + way[1] * r + way[0] * w,
			faces->of[face] ? 0.35 + 0.65 * coverage_of(faces->of[face]) : 0.08);
	}
	if (faces->of[5])
		fprintf(to, "<circle cx=\"%.0f\" cy=\"%.0f\" r=\"3\" fill=\"#fff\"/>", (double)x,
			(double)y);
	if (faces->of[4])
		fprintf(to,
			"<circle cx=\"%.0f\" cy=\"%.0f\" r=\"%d\" fill=\"none\" stroke=\"#fff\"/>",
			(double)x, (double)y, POINT_RADIUS + 2);
}

static void put_point(FILE *to, const struct report_data *data, const uint32_t point[3])
{
	static const char *const states[] = { "rendered", "sees nothing", "inside solid matter",
					      "below the ground" };
	const struct sample_grid *grid = samples_store_grid(data->store);
	enum sample_state state = samples_store_state(data->store, point);
	struct point_faces faces = faces_of(data, point);
	float place[3], x, y;
	uint32_t count = 0;

	sampler_point(place, grid, point);
	if (!camera_pixel(&data->portraits[REPORT_ABOVE].camera, place, &x, &y))
		return;
	for (int face = 0; face < CUBE_FACES; face++)
		count += faces.of[face] != NULL;
	fprintf(to, "<g><title>point %u, %u, %u: %s", point[0], point[1], point[2], states[state]);
	if (count > 0) {
		fprintf(to, ", %u faces, ", count);
		html_bytes(to, faces.bytes);
	}
	fputs("</title>", to);
	if (state == SAMPLE_RENDERED)
		put_glyph(to, x, y, &faces);
	else if (state == SAMPLE_INSIDE)
		fprintf(to,
			"<path d=\"M%.0f %.0fl12 12m0 -12l-12 12\" stroke=\"var(--border)\" "
			"stroke-width=\"3\"/>",
			(double)x - 6, (double)y - 6);
	else
		fprintf(to,
			"<circle cx=\"%.0f\" cy=\"%.0f\" r=\"4\" fill=\"none\" stroke=\"%s\" "
			"stroke-width=\"2\"/>",
			(double)x, (double)y, state == SAMPLE_EMPTY ? "#888" : "#b08040");
	fputs("</g>\n", to);
}

static void put_layers(FILE *to, const struct report_data *data)
{
	const struct sample_grid *grid = samples_store_grid(data->store);

	fputs("<div class=\"two\">\n", to);
	for (uint32_t z = 0; z < grid->count[2]; z++) {
		fprintf(to,
			"<figure><svg class=\"picture above\" viewBox=\"0 0 %d %d\" role=\"img\" "
			"aria-label=\"Layer %u from above\">\n",
			REPORT_PICTURE_WIDTH_PX, REPORT_PICTURE_HEIGHT_PX, z + 1);
		for (uint32_t y = 0; y < grid->count[1]; y++)
			for (uint32_t x = 0; x < grid->count[0]; x++) {
				const uint32_t point[3] = { x, y, z };

				put_point(to, data, point);
			}
		fprintf(to, "</svg><figcaption>Layer %u, at a height of ", z + 1);
		html_length(to, fabs((double)(grid->origin_m[2] + grid->spacing_m[2] * (float)z -
					      data->master->box_min_m[2])));
		fputs(" above the model's lowest point</figcaption></figure>\n", to);
	}
	fputs("</div>\n", to);
}

/* Vantage points, which are on no layer. */
static void put_vantages(FILE *to, const struct report_data *data)
{
	const struct sample_grid *grid = samples_store_grid(data->store);

	for (uint32_t i = 0; i < grid->vantage_count; i++) {
		struct point_faces faces;
		uint32_t point[3], count = 0;

		sample_grid_point(grid, sample_grid_points(grid) - grid->vantage_count + i, point);
		faces = faces_of(data, point);
		for (int face = 0; face < CUBE_FACES; face++)
			count += faces.of[face] != NULL;
		fputs("<p>The ", to);
		put_point_name(to, data, point);
		fprintf(to, " has a sampling point of its own: %u faces, ", count);
		html_bytes(to, faces.bytes);
		fputs(".</p>\n", to);
	}
}

static void put_thumbnails(FILE *to, const struct report_data *data)
{
	fputs("<p style=\"margin-top:18px\">Some of the faces, at their coarsest:</p>"
	      "<div class=\"thumbs\">\n",
	      to);
	for (uint32_t i = 0; i < data->face_count; i++) {
		const struct report_face *face = &data->faces[i];

		if (face->thumbnail.size == 0)
			continue;
		fputs("<figure><img alt=\"\" src=\"", to);
		html_data(to, "image/webp", buffer_bytes(&face->thumbnail));
		fputs("\"><figcaption>", to);
		put_point_name(to, data, face->point);
		fprintf(to, ": %s</figcaption></figure>\n", cube_face_names[face->face]);
	}
	fputs("</div></section>\n", to);
}

static void put_samples(FILE *to, const struct report_data *data)
{
	begin_section(
		to, "Where pictures were taken",
		"The grid of sampling points from above, layer by layer. A wedge is a face that "
		"sees the model in that direction, the stronger the more it sees; the dot is "
		"the face that looks down, the ring the one that looks up. A cross is a point "
		"in solid matter, an empty circle one that sees nothing.");
	fputs("<div class=\"facts\">\n", to);
	put_count(to, data->states[SAMPLE_RENDERED], "points rendered");
	put_count(to, data->states[SAMPLE_EMPTY], "see nothing");
	put_count(to, data->states[SAMPLE_INSIDE], "inside solid matter");
	put_count(to, data->states[SAMPLE_GROUND], "below the ground");
	put_count(to, data->face_count, "faces");
	put_count(to, data->tile_count, "tiles");
	fputs("</div>\n", to);
	put_layers(to, data);
	put_vantages(to, data);
	put_thumbnails(to, data);
}

/* ---- storage */

static void put_storage(FILE *to, const struct report_data *data)
{
	const uint64_t all = data->options->publish->release_bytes;
	const uint64_t known = data->tile_bytes + data->patch_bytes + data->file_bytes;
	const struct {
		const char *name;
		uint64_t bytes;
	} kinds[] = {
		{ "Tiles: pictures of the scan", data->tile_bytes },
		{ "Patches: its geometry", data->patch_bytes },
		{ "Pictures and spoken texts of pages", data->file_bytes },
		{ "Texts, labels, and the pages that name the others",
		  all > known ? all - known : 0 },
	};

	begin_section(to, "What the release is made of",
		      "All objects of the release, without its signed files.");
	fputs("<div class=\"stack\" aria-hidden=\"true\">", to);
	for (size_t i = 0; i < ARRAY_COUNT(kinds); i++)
		fprintf(to, "<i style=\"flex:%.3f\"></i>",
			(double)kinds[i].bytes / (double)(all ? all : 1));
	fputs("</div>\n<div class=\"scroll card\"><table>", to);
	for (size_t i = 0; i < ARRAY_COUNT(kinds); i++) {
		fprintf(to, "<tr><td><span class=\"key of\"></span>%s</td><td>", kinds[i].name);
		html_bytes(to, kinds[i].bytes);
		fprintf(to, "</td><td>%.1f&#8239;%%</td></tr>\n",
			100 * (double)kinds[i].bytes / (double)(all ? all : 1));
	}
	fputs("</table></div></section>\n", to);
}

/* Returns the title of the smallest part with that place in its region; "" if there is none. */
static const char *part_at(struct info *info, const float place_m[3])
{
	float smallest = INFINITY;
	const char *title = "";

	for (uint32_t i = 0; info && i < info_part_count(info); i++) {
		const struct region *region = &info_part(info, i)->region;
		float size = region_size_m(region);
		bool inside = region_contains(region, place_m);

		if (region->kind == REGION_POINT) {
			size = region->radius_m;
			inside = vec_distance(place_m, region->centre_m) <= size;
		}
		if (inside && size < smallest) {
			smallest = size;
			title = info_text(info, i, info_language(info, 0)).title;
		}
	}
	return title;
}

static void put_costly(FILE *to, const struct report_data *data)
{
	const struct info_built *built;
	struct info *info = NULL;

	begin_section(
		to, "The ten costliest places",
		"What takes most of the release: faces of sampling points, and groups of "
		"patches as they lie in the master. Fine relief seen from near is rightly among them; plants and cables "
		"that nobody wants to see may be cut out of the scan.");
	if (sources_info(data->options->sources, &built) < 0 ||
	    info_open(&info, buffer_bytes(&built->database)) < 0)
		info = NULL;
	fputs("<div class=\"scroll card\"><table><tr><th>what</th><th>bytes</th><th>holds</th>"
	      "<th>near</th><th class=\"left\">part</th></tr>\n",
	      to);
	for (uint32_t i = 0; i < data->costly_count; i++) {
		const struct report_costly *costly = &data->costly[i];

		fputs("<tr><td>", to);
		if (costly->is_face) {
			fprintf(to, "face %s of point ", cube_face_names[costly->face]);
			put_point_name(to, data, costly->point);
		} else {
			fputs("a group of patches", to);
		}
		fputs("</td>", to);
		html_bar(to, (double)costly->bytes / (double)data->costly[0].bytes);
		html_bytes(to, costly->bytes);
		html_bar_end(to);
		fprintf(to, "<td>%u %s</td><td>%.2f, %.2f, %.2f m</td><td class=\"left\">",
			costly->count, costly->is_face ? "tiles" : "patches",
			(double)costly->centre_m[0], (double)costly->centre_m[1],
			(double)costly->centre_m[2]);
		html_text(to, part_at(info, costly->centre_m));
		fputs("</td></tr>\n", to);
	}
	fputs("</table></div></section>\n", to);
	info_close(info);
}

/* ---- the build */

static void put_stages(FILE *to, const struct report_data *data)
{
	int64_t most = 1;

	begin_section(to, "What this build took",
		      "By the clock, of all processors together, and the memory of its largest "
		      "process.");
	for (uint32_t i = 0; i < data->options->stage_count; i++)
		if (data->options->stages[i].ms > most)
			most = data->options->stages[i].ms;
	fputs("<div class=\"scroll card\"><table><tr><th>stage</th><th>time</th>"
	      "<th>processor</th><th>memory</th></tr>\n",
	      to);
	for (uint32_t i = 0; i < data->options->stage_count; i++) {
		const struct report_stage *stage = &data->options->stages[i];

		fprintf(to, "<tr><td>%s%s</td>", stage->name,
			stage->was_there ? " (was there)" : "");
		html_bar(to, (double)stage->ms / (double)most);
		html_time(to, stage->ms);
		html_bar_end(to);
		fputs("<td>", to);
		html_time(to, stage->processor_us / 1000);
		fputs("</td><td>", to);
		if (stage->memory_bytes > 0)
			html_bytes(to, stage->memory_bytes);
		fputs("</td></tr>\n", to);
	}
	fputs("</table></div></section>\n", to);
}

static int write_page(const struct report_data *data, const char *path)
{
	char *text = NULL;
	size_t size = 0;
	FILE *to = open_memstream(&text, &size);
	bool failed;
	int rc;

	if (!to)
		return -errno;
	put_head(to, data);
	put_facts(to, data);
	put_pictures(to, data);
	put_scan_section(to, data);
	put_levels(to, data);
	put_samples(to, data);
	put_storage(to, data);
	put_costly(to, data);
	put_stages(to, data);
	fputs("</main></body></html>\n", to);
	failed = ferror(to);
	if (fclose(to) != 0)
		failed = true;
	rc = failed ? -ENOMEM : bytes_write_file((struct bytes){ (uint8_t *)text, size }, path);
	free(text);
	return rc;
}

int report_write(const struct report_options *options, char path[CONTENT_PATH_BYTES])
{
	struct report_data *data = malloc(sizeof(*data));
	int rc = data ? content_work_path(sources_content(options->sources), "report.html", path)
		      : -ENOMEM;

	if (rc == 0) {
		rc = report_data_read(data, options);
		if (rc == 0) {
			rc = write_page(data, path);
			if (rc < 0)
				log_error("pipeline", "%s: %s", path, strerror(-rc));
		}
		report_data_finish(data);
	}
	free(data);
	return rc;
}
