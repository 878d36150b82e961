/* Compiles the parts, pages, tours, pictures and spoken texts of a content folder into one SQLite
 * image. The same folder gives the same bytes. storage/info.h reads it; docs/information.md has the
 * tables. */
#ifndef GOPURA_PIPELINE_CONTENT_INFO_BUILD_H
#define GOPURA_PIPELINE_CONTENT_INFO_BUILD_H

#include "base/diagnostics.h"
#include "storage/info.h"

/* For diagnostics.max: more than anybody corrects at once. */
enum { INFO_DIAGNOSTICS_MAX = 100000 };

/* A region that is a list of faces of a scan. */
struct info_faces {
	const char *part; /* id of the part */
	const char *file; /* relative to the folder */
	const char *scan; /* as in temple.ini; NULL: the only scan */
	/* Results: where it lies, and a place on it. */
	float centre_m[3], radius_m, anchor_m[3];
};
/* Works on one list. -EINVAL: diagnostics says what is wrong and how to correct it. */
typedef int info_faces_call(void *data, struct info_faces *faces, struct diagnostics *diagnostics);

/* A text that is taken instead of a file's, as if it had been saved: parts.json, tours.json, a
 * page, or what is spoken on it. data NULL: as if there were no such file. */
struct info_text_instead {
	const char *name; /* relative to the folder */
	struct bytes text;
};

struct info_build_options {
	const char *folder; /* content folder: parts.json, tours.json, pages/, pictures/ */
	const char *const *languages; /* such as "en"; every title must exist in the first one */
	uint32_t language_count;      /* 1 .. INFO_LANGUAGES_MAX */
	unsigned tools;               /* bits of enum info_tool */
	double scan_error_m;          /* said to those who measure; above 0 with that tool */
	const struct info_text_instead *instead;
	uint32_t instead_count;
	/* Looks at no more than the first bytes of pictures, and does not decode sound, for a check
	 * while somebody waits. Pictures' size is then 1 by 1 and their hash 0, so nothing can be
	 * published. */
	bool skims_pictures;
	/* Gets every fault and every warning; files are relative to the folder. Borrowed. */
	struct diagnostics *diagnostics;
	info_faces_call *judge_faces; /* checks a list without the scan; NULL: none is checked */
	info_faces_call *place_faces; /* fills in its place; NULL: all are at 0 0 0 */
	void *faces_data;
};

/* A picture, or a spoken text. */
struct info_file {
	struct hash hash; /* of the file's bytes; it is the name of the object */
	uint32_t size;    /* bytes */
	char *name;       /* owned; such as "pictures/gate.jpg", relative to the content folder */
};

/* Lines in tours.json of a tour and its stops, for diagnostics of its path. */
struct info_tour_lines {
	unsigned tour, stops[INFO_STOPS_MAX];
};

struct info_built {
	struct buffer database; /* the SQLite image */
	uint32_t part_count, page_count, file_count, tour_count;
	struct info_tour_lines tour_lines[INFO_TOURS_MAX];
	struct info_file *files; /* owned; sorted by hash, each hash once */
};

/* A folder as read and checked: everything but where its lists of faces lie. */
struct draft;

/* Reads and checks the folder; a list of faces only by judge_faces. A folder without parts.json has
 * no parts. options is borrowed for the draft's lifetime. *out is owned by the caller; NULL on
 * failure. -EINVAL: the content has faults, and every one was added to the diagnostics. -ENOMEM,
 * -EIO. */
must_check int info_read(struct draft **out, const struct info_build_options *options);
void info_draft_destroy(struct draft *draft); /* NULL is fine */
/* Returns whether there are tours. */
bool info_has_tours(const struct draft *draft);
/* Places the lists of faces and the stops that depend on them, and builds the image. Once for a
 * draft. The caller finishes *out; it is zeroed on failure. Errors as of info_read. */
must_check int info_compile(struct info_built *out, struct draft *draft);

/* info_read and info_compile in one. */
must_check int info_build(struct info_built *out, const struct info_build_options *options);
/* Frees the contents. NULL and zeroed are fine. */
void info_built_finish(struct info_built *built);

#endif
