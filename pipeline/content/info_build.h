/* Compiles the parts, pages, tours and pictures of a content folder into one SQLite image, the same
 * bytes for the same folder; storage/info.h reads it. docs/information.md has the tables. */
#ifndef GOPURA_PIPELINE_CONTENT_INFO_BUILD_H
#define GOPURA_PIPELINE_CONTENT_INFO_BUILD_H

#include "base/fault.h"
#include "storage/info.h"

/* One thing found in the content folder. file is relative to the folder, line is 0 where none
 * applies, text says what is wrong and what cures it. All borrowed for the call. */
typedef void info_complaint(void *data, bool is_error, const char *file, unsigned line,
			    const char *text);

/* A region that is a list of faces of a scan. */
struct info_faces {
	const char *part; /* its id */
	const char *file; /* relative to the folder */
	const char *scan; /* as temple.ini has it; NULL: the only one */
	float centre_m[3], radius_m,
		anchor_m[3]; /* to be filled in: where it lies; a place on it */
};
/* Judges and places it. -EINVAL: fault says what is wrong, with the cure. */
typedef int info_place_faces(void *data, struct info_faces *faces, struct fault *fault);

struct info_build_options {
	const char *folder; /* the content folder: parts.json, tours.json, pages/, pictures/ */
	const char *const *languages; /* such as "en"; the first must have every title */
	uint32_t language_count;      /* 1 .. INFO_LANGUAGES_MAX */
	unsigned tools;               /* enum info_tool */
	info_complaint *complaint;    /* NULL: they are logged */
	void *complaint_data;
	info_place_faces *place_faces; /* NULL: lists of faces are not looked into */
	void *place_faces_data;
};

struct info_picture_file {
	struct hash hash; /* of the file's bytes: the object's name */
	uint32_t size;    /* bytes */
	char *name;       /* owned; such as "pictures/gate.jpg", relative to the content folder */
};

/* Where in tours.json a tour stands, and its stops: for those who find fault with its way. */
struct info_tour_lines {
	unsigned tour, stops[INFO_STOPS_MAX];
};

struct info_built {
	struct buffer database; /* the SQLite image */
	uint32_t part_count, page_count, picture_count, tour_count;
	struct info_tour_lines tour_lines[INFO_TOURS_MAX];
	struct info_picture_file *pictures; /* owned; sorted by hash, each hash once */
};

/* A folder without parts.json gives a database without parts. *out is finished by the caller; on
 * failure it is zeroed. -EINVAL: the content is at fault and every fault was complained about;
 * -ENOMEM, -EIO. */
must_check int info_build(struct info_built *out, const struct info_build_options *options);
void info_built_finish(struct info_built *built); /* NULL and zeroed are fine */

#endif
