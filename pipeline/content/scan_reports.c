/* Encodes and decodes the reports of the import. */
#include "pipeline/content/scan_reports.h"

#include <errno.h>
#include <string.h>

#include "base/bytes.h"

enum { REPORTS_VERSION = 1, REPORTS_BYTES_MAX = 4 << 20 };

/* What is kept of the counts, in the order of the file. */
static uint32_t *count_of(struct import_report *report, int i)
{
	struct mesh_repairs *repairs = &report->repairs;
	uint32_t *const counts[] = {
		&report->textures,         &report->vertices,          &report->triangles,
		&repairs->lost_faces,      &repairs->degenerate_faces, &repairs->merged_vertices,
		&repairs->unused_vertices, &repairs->border_edges,     &repairs->non_manifold_edges,
		&repairs->turned_faces,    &repairs->turned_edges,     &repairs->place_step,
		&repairs->place_count,
	};

	return i < (int)ARRAY_COUNT(counts) ? counts[i] : NULL;
}

static void encode_report(struct buffer *file, struct import_report *report)
{
	const struct mesh_repairs *repairs = &report->repairs;

	buffer_put_string(file, report->format);
	buffer_put_u8(file, report->had_colours);
	buffer_put_u64(file, report->file_bytes);
	for (int i = 0; count_of(report, i); i++)
		buffer_put_u32(file, *count_of(report, i));
	for (uint32_t i = 0; i < repairs->place_count; i++) {
		buffer_put_u8(file, (uint8_t)repairs->places[i].kind);
		for (int k = 0; k < 3; k++)
			buffer_put_f32(file, repairs->places[i].place_m[k]);
	}
}

static bool decode_report(struct import_report *report, struct reader *reader)
{
	struct mesh_repairs *repairs = &report->repairs;

	reader_string(reader, report->format, sizeof(report->format));
	report->had_colours = reader_u8(reader);
	report->file_bytes = reader_u64(reader);
	for (int i = 0; count_of(report, i); i++)
		*count_of(report, i) = reader_u32(reader);
	if (reader->failed || repairs->place_count > MESH_FAULT_PLACES_MAX)
		return false;
	for (uint32_t i = 0; i < repairs->place_count; i++) {
		uint8_t kind = reader_u8(reader);

		if (kind >= MESH_FAULTS)
			return false;
		repairs->places[i].kind = (enum mesh_fault)kind;
		for (int k = 0; k < 3; k++)
			repairs->places[i].place_m[k] = reader_f32(reader);
	}
	return !reader->failed;
}

/* The file contains: version, the key of the scans, the number of reports, and each. */
int scan_reports_save(const char *path, struct hash key, struct import_report *reports,
		      uint32_t count)
{
	struct buffer file;
	int rc;

	buffer_init(&file, REPORTS_BYTES_MAX);
	buffer_put_u32(&file, REPORTS_VERSION);
	buffer_put(&file, key.bytes, HASH_BYTES);
	buffer_put_u32(&file, count);
	for (uint32_t i = 0; i < count; i++)
		encode_report(&file, &reports[i]);
	rc = file.error ? file.error : bytes_write_file(buffer_bytes(&file), path);
	buffer_finish(&file);
	return rc;
}

static int decode_reports(struct import_report *reports, struct bytes file, struct hash key)
{
	struct reader reader;
	uint32_t version, count;
	struct bytes of;

	reader_init(&reader, file);
	version = reader_u32(&reader);
	of = reader_bytes(&reader, HASH_BYTES);
	count = reader_u32(&reader);
	if (reader.failed || version != REPORTS_VERSION || count > CONTENT_SCANS_MAX ||
	    memcmp(of.data, key.bytes, HASH_BYTES) != 0)
		return -ENOENT;
	for (uint32_t i = 0; i < count; i++)
		if (!decode_report(&reports[i], &reader))
			return -ENOENT;
	return (int)count;
}

int scan_reports_load(struct import_report *reports, const char *path, struct hash key)
{
	struct buffer file;
	int rc;

	buffer_init(&file, REPORTS_BYTES_MAX);
	rc = buffer_read_file(&file, path);
	if (rc == 0)
		rc = decode_reports(reports, buffer_bytes(&file), key);
	buffer_finish(&file);
	return rc;
}
