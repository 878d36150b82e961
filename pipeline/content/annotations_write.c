/* Writes an imported content folder, and removes the files again if the folder's own readers refuse
 * them. */
#include "pipeline/content/annotations_write.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/array.h"
#include "base/json_tree.h"
#include "base/safe_open.h"

static int note_written(struct importer *im, const char *path)
{
	int rc = ARRAY_RESERVE(im->written, im->written_room, im->written_count + 1, UINT32_MAX);

	if (rc < 0)
		return rc;
	im->written[im->written_count] = strdup(path);
	if (!im->written[im->written_count])
		return -ENOMEM;
	im->written_count++;
	return 0;
}

static int write_file(struct importer *im, const char *name, struct bytes bytes)
{
	char path[PATH_MAX];
	int rc;

	if (snprintf(path, sizeof(path), "%s/%s", im->options->folder, name) >= PATH_MAX)
		return -ENAMETOOLONG;
	rc = note_written(im, path);
	if (rc == 0)
		rc = bytes_write_file(bytes, path);
	if (rc < 0)
		diagnostics_add(im->diagnostics, -EINVAL, im->options->file, 0,
				"%s cannot be written: %s", path, strerror(-rc));
	return rc;
}

static int make_folder(struct importer *im, const char *name)
{
	char path[PATH_MAX];

	if (snprintf(path, sizeof(path), "%s/%s", im->options->folder, name) >= PATH_MAX)
		return -ENAMETOOLONG;
	if (mkdir(path, 0755) == 0)
		return note_written(im, path);
	if (errno == EEXIST)
		return 0;
	diagnostics_add(im->diagnostics, -EINVAL, im->options->file, 0, "%s cannot be made: %s",
			path, strerror(errno));
	return -EIO;
}

/* The folder of the file may be a stranger's: a link in it could bring in a private file. */
static int copy_picture(struct importer *im, const char *folder, const char *name)
{
	char to[PATH_MAX], relative[300];
	struct buffer file;
	int rc;

	snprintf(relative, sizeof(relative), "pictures/%s", name);
	if (snprintf(to, sizeof(to), "%s/%s", im->options->folder, relative) >= PATH_MAX)
		return -ENAMETOOLONG;
	if (access(to, F_OK) == 0) /* already in the folder, or the same file */
		return 0;
	if (errno != ENOENT)
		return diagnostics_add(im->diagnostics, -errno, to, 0, "%s", strerror(errno));
	buffer_init(&file, 64 << 20);
	rc = buffer_read_beneath(&file, folder, relative);
	if (rc < 0)
		rc = diagnostics_add(im->diagnostics, rc == -ENOMEM ? rc : -EINVAL,
				     im->options->file, 0, "%s/%s cannot be read: %s", folder,
				     relative, open_problem(rc));
	else
		rc = write_file(im, relative, buffer_bytes(&file));
	buffer_finish(&file);
	im->report->picture_count += rc == 0;
	return rc;
}

/* Writes the file's folder, or ".", to folder (PATH_MAX bytes). */
static void folder_of(const char *file, char *folder)
{
	char *slash;

	snprintf(folder, PATH_MAX, "%s", file);
	slash = strrchr(folder, '/');
	if (!slash)
		snprintf(folder, PATH_MAX, ".");
	else
		slash[slash == folder] = 0;
}

/* Copies all pictures beside the file, because it is not known yet which of them the pages use. */
static int copy_pictures(struct importer *im)
{
	char folder[PATH_MAX], from[2 * PATH_MAX];
	struct dirent **entries = NULL;
	int count, rc = 0;

	folder_of(im->options->file, folder);
	snprintf(from, sizeof(from), "%s/pictures", folder);
	count = scandir(from, &entries, NULL, alphasort);
	if (count > 0)
		rc = make_folder(im, "pictures");
	for (int i = 0; i < count; i++) {
		struct stat info;

		snprintf(from, sizeof(from), "%s/pictures/%s", folder, entries[i]->d_name);
		if (rc == 0 && entries[i]->d_name[0] != '.' && stat(from, &info) == 0 &&
		    S_ISREG(info.st_mode))
			rc = copy_picture(im, folder, entries[i]->d_name);
		free(entries[i]);
	}
	free(entries);
	return rc;
}

/* Writes tours.json with the tours of the file. */
static int write_tours(struct importer *im)
{
	cJSON *file = cJSON_CreateObject();
	char *text = NULL;
	int rc = -ENOMEM;

	if (file && json_add(file, "tours", cJSON_Duplicate(im->tours, true)))
		text = json_indented(file);
	if (text)
		rc = write_file(im, "tours.json",
				(struct bytes){ (const uint8_t *)text, strlen(text) });
	cJSON_free(text);
	cJSON_Delete(file);
	return rc;
}

static int write_all(struct importer *im)
{
	char *text = json_indented(im->parts_file);
	int rc = text ? make_folder(im, "") : -ENOMEM;

	if (rc == 0)
		rc = write_file(im, "parts.json",
				(struct bytes){ (const uint8_t *)text, strlen(text) });
	if (rc == 0 && im->tours)
		rc = write_tours(im);
	if (rc == 0)
		rc = make_folder(im, "pages");
	for (uint32_t i = 0; i < im->page_count && rc == 0; i++)
		rc = write_file(im, im->pages[i].name,
				(struct bytes){ (const uint8_t *)im->pages[i].html,
						strlen(im->pages[i].html) });
	if (rc == 0)
		rc = copy_pictures(im);
	im->report->page_count = im->page_count;
	cJSON_free(text);
	return rc;
}

/* Checks the result like a release with all its languages. */
static int check_written(struct importer *im)
{
	const char *languages[INFO_LANGUAGES_MAX] = { "en" };
	struct info_build_options build = { .folder = im->options->folder,
					    .languages = languages,
					    .diagnostics = im->options->diagnostics };
	struct info_built built;
	int rc;

	build.language_count = annotation_languages(im->parts_file, languages);
	if (build.language_count == 0)
		build.language_count = 1;
	rc = info_build(&built, &build);
	if (rc == 0)
		info_built_finish(&built);
	return rc;
}

static void take_away(struct importer *im)
{
	for (size_t i = im->written_count; i-- > 0;)
		remove(im->written[i]); /* our folders are empty by now */
}

bool importer_has_room(struct importer *im)
{
	static const char *const names[] = { "parts.json", "pages", "tours.json" };

	for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
		char path[PATH_MAX];

		snprintf(path, sizeof(path), "%s/%s", im->options->folder, names[i]);
		if (i == 1 && rmdir(path) == 0) /* an empty folder is removed */
			continue;
		if (access(path, F_OK) == 0)
			diagnostics_add(im->diagnostics, -EINVAL, im->options->file, 0,
					"%s exists already: import into a folder without parts and "
					"pages",
					path);
		else if (errno != ENOENT)
			diagnostics_add(im->diagnostics, -errno, path, 0, "%s", strerror(errno));
		else
			continue;
		return false;
	}
	return true;
}

int importer_write(struct importer *im)
{
	int rc = write_all(im);

	if (rc == 0)
		rc = check_written(im);
	if (rc < 0)
		take_away(im);
	return rc;
}
