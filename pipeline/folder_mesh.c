#include "pipeline/folder.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/bytes.h"
#include "base/log.h"
#include "pipeline/mesh_file.h"

enum { KEY_BYTES_MOST = 1 << 20, MESH_VERSION = 1 };

static int scan_path(char path[PATH_MAX], const struct folder *folder, uint32_t n)
{
	int size = folder->scans[n][0] == '/'
			   ? snprintf(path, PATH_MAX, "%s", folder->scans[n])
			   : snprintf(path, PATH_MAX, "%s/%s", folder->dir, folder->scans[n]);

	return size < PATH_MAX ? 0 : -ENAMETOOLONG;
}

static int hash_file(struct hash *out, const char *path)
{
	struct stat stat;
	int fd = open(path, O_RDONLY | O_CLOEXEC), rc = 0;
	void *map;

	if (fd < 0)
		return -errno;
	if (fstat(fd, &stat) < 0) {
		rc = -errno;
	} else if (stat.st_size == 0) {
		*out = hash_of((struct bytes){ NULL, 0 });
	} else {
		map = mmap(NULL, (size_t)stat.st_size, PROT_READ, MAP_PRIVATE, fd, 0);
		if (map == MAP_FAILED) {
			rc = -errno;
		} else {
			*out = hash_of((struct bytes){ map, (size_t)stat.st_size });
			munmap(map, (size_t)stat.st_size);
		}
	}
	close(fd);
	return rc;
}

static int is_companion(const struct dirent *entry)
{
	static const char *const endings[] = { ".mtl", ".jpg", ".jpeg", ".png", ".bin" };
	const char *dot = strrchr(entry->d_name, '.');

	for (size_t i = 0; dot && i < ARRAY_COUNT(endings); i++)
		if (strcasecmp(dot, endings[i]) == 0)
			return 1;
	return 0;
}

/* Materials and pictures beside a scan: by name, size and time. */
static void put_companions(struct buffer *text, const char *scan)
{
	struct dirent **entries;
	char dir[PATH_MAX], *slash;
	int count;

	snprintf(dir, sizeof(dir), "%s", scan);
	slash = strrchr(dir, '/');
	if (slash)
		*slash = '\0';
	count = scandir(slash ? dir : ".", &entries, is_companion, alphasort);
	for (int i = 0; i < count; i++) {
		char path[PATH_MAX + 256];
		struct stat stat_of;

		snprintf(path, sizeof(path), "%s/%s", slash ? dir : ".", entries[i]->d_name);
		if (stat(path, &stat_of) == 0) {
			buffer_put_string(text, entries[i]->d_name);
			buffer_put_u64(text, (uint64_t)stat_of.st_size);
			buffer_put_u64(text, (uint64_t)stat_of.st_mtim.tv_sec);
			buffer_put_u64(text, (uint64_t)stat_of.st_mtim.tv_nsec);
		}
		free(entries[i]);
	}
	if (count >= 0)
		free(entries);
}

int folder_mesh_key(const struct folder *folder, struct hash *key, struct fault *fault)
{
	struct buffer text;
	int rc = 0;

	buffer_init(&text, KEY_BYTES_MOST);
	buffer_put_u32(&text, MESH_VERSION);
	buffer_put_u32(&text, folder->import.up);
	buffer_put_f64(&text, folder->import.metres_per_unit);
	buffer_put(&text, folder->import.default_colour, 3);
	buffer_put_u8(&text, folder->import.override_colour);
	for (uint32_t n = 0; n < folder->scan_count; n++) {
		char path[PATH_MAX];
		const char *dot;
		struct hash hash;

		rc = scan_path(path, folder, n);
		if (rc == 0)
			rc = hash_file(&hash, path);
		if (rc < 0) {
			fault_set(fault, rc, "%s: %s; [model] scans in temple.ini names it", path,
				  strerror(-rc));
			break;
		}
		buffer_put(&text, hash.bytes, HASH_BYTES);
		dot = strrchr(path, '.');
		if (dot && strcasecmp(dot, ".stl") != 0 && strcasecmp(dot, ".off") != 0)
			put_companions(&text, path);
	}
	*key = hash_of(buffer_bytes(&text));
	if (rc == 0)
		rc = text.error;
	buffer_finish(&text);
	return rc;
}

static int import_all(const struct folder *folder, struct mesh *out, struct fault *fault)
{
	int rc = 0;

	for (uint32_t n = 0; rc == 0 && n < folder->scan_count; n++) {
		struct import_report report;
		struct mesh mesh;
		char path[PATH_MAX];

		rc = scan_path(path, folder, n);
		if (rc < 0)
			return rc;
		rc = import_scan(&mesh, path, &folder->import, &report, fault);
		if (rc < 0)
			return rc;
		log_info("pipeline", "%s: %u triangles, %u vertices", folder->scans[n],
			 report.triangles, report.vertices);
		if (report.warning.text[0])
			log_warn("pipeline", "%s", report.warning.text);
		if (n == 0) {
			*out = mesh;
			continue;
		}
		rc = mesh_append(out, &mesh);
		mesh_finish(&mesh);
		if (rc < 0)
			fault_set(fault, rc, "%s: cannot be joined to the other scans: %s", path,
				  strerror(-rc));
	}
	return rc;
}

int folder_mesh(const struct folder *folder, struct mesh *out, struct hash *key,
		struct fault *fault)
{
	char path[PATH_MAX];
	int rc;

	*out = (struct mesh){ 0 };
	rc = folder_mesh_key(folder, key, fault);
	if (rc < 0)
		return rc;
	snprintf(path, sizeof(path), "%s/.work/mesh", folder->dir);
	if (mesh_file_load(out, *key, path) == 0)
		return 0;
	rc = import_all(folder, out, fault);
	if (rc == 0 && out->triangle_count == 0)
		rc = fault_set(fault, -EINVAL, "%s: the scans hold no triangle", folder->dir);
	if (rc == 0)
		rc = folder_make_work(folder, NULL);
	if (rc == 0)
		rc = mesh_file_save(out, *key, path);
	if (rc < 0) {
		mesh_finish(out);
		return fault_set(fault, rc, "%s: %s", path, strerror(-rc));
	}
	return 0;
}
