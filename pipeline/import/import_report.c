/* Prints the import report as text. */
#include "pipeline/import/import_report.h"

#include <inttypes.h>

static void print_count(FILE *to, uint64_t count, const char *one, const char *many)
{
	if (count > 0)
		fprintf(to, "  %" PRIu64 " %s\n", count, count == 1 ? one : many);
}

static void print_repairs(FILE *to, const struct mesh_repairs *repairs)
{
	print_count(to, repairs->lost_faces, "face with a corner that is not a number, dropped",
		    "faces with a corner that is not a number, dropped");
	print_count(to, repairs->degenerate_faces, "degenerate face, dropped",
		    "degenerate faces, dropped");
	print_count(to, repairs->merged_vertices, "duplicate vertex, merged",
		    "duplicate vertices, merged");
	print_count(to, repairs->unused_vertices, "vertex without a face, removed",
		    "vertices without a face, removed");
	print_count(to, repairs->turned_faces, "face showing the wrong side, turned",
		    "faces showing the wrong side, turned");
	print_count(to, repairs->border_edges, "border edge: the scan is open there",
		    "border edges: the scan is open there");
	print_count(to, repairs->non_manifold_edges, "edge of three faces or more, tolerated",
		    "edges of three faces or more, tolerated");
	print_count(to, repairs->turned_edges, "edge whose faces show opposite sides, tolerated",
		    "edges whose faces show opposite sides, tolerated");
}

void import_report_print(FILE *to, const char *path, const struct import_report *report)
{
	fprintf(to, "%s: %s, %" PRIu32 " %s, %" PRIu32 " vertices, %.1f s\n", path, report->format,
		report->triangles, report->triangles == 1 ? "triangle" : "triangles",
		report->vertices, (double)report->duration_ms / 1000);
	fprintf(to, "  box %.3f %.3f %.3f to %.3f %.3f %.3f m\n", report->low_m[0],
		report->low_m[1], report->low_m[2], report->high_m[0], report->high_m[1],
		report->high_m[2]);
	if (report->textures)
		fprintf(to, "  colours: %" PRIu32 " picture%s\n", report->textures,
			report->textures == 1 ? "" : "s");
	else
		fprintf(to, "  colours: %s\n",
			report->had_colours ? "the scan's own" : "none, one for all");
	if (report->had_open_sky)
		fprintf(to, "  open share of the sky: in alpha\n");
	print_repairs(to, &report->repairs);
	print_count(to, report->strange_lines, "header line not understood, skipped",
		    "header lines not understood, skipped");
	print_count(to, report->trailing_bytes, "byte behind the last element, ignored",
		    "bytes behind the last element, ignored");
	if (report->warning.first.text[0])
		fprintf(to, "  warning: %s\n", report->warning.first.text);
}
