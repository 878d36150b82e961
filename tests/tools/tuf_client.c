/* A client of The Update Framework for its conformance suite, which drives it by this protocol:
 *
 *   tuf_client --metadata-dir DIR init TRUSTED_ROOT
 *   tuf_client --metadata-dir DIR --metadata-url URL refresh
 *   tuf_client --metadata-dir DIR --metadata-url URL --target-name PATH --target-base-url URL
 *              --target-dir DIR download
 *
 * With --ca FILE certificates are checked against these authorities. Exit status 0: done; 1: not.
 * The workflow is tuf/workflow.h's; files and requests are here. */
#include <curl/curl.h>
#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tuf/role_files.h"
#include "tuf/targets.h"

struct options {
	const char *metadata_dir, *metadata_url, *target_name, *target_url, *target_dir, *ca;
};

/* ---- files */

static int load(void *context, const char *name, struct buffer *out)
{
	const struct options *options = context;
	char path[PATH_MAX];

	snprintf(path, sizeof(path), "%s/%s", options->metadata_dir, name);
	return buffer_read_file(out, path);
}

static int keep(const char *folder, const char *name, struct bytes file)
{
	char path[PATH_MAX], part[PATH_MAX + 8];
	int fd, rc = 0;

	snprintf(path, sizeof(path), "%s/%s", folder, name);
	snprintf(part, sizeof(part), "%s.part", path);
	fd = open(part, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
	if (fd < 0)
		return -errno;
	if (write(fd, file.data, file.size) != (ssize_t)file.size || fsync(fd) < 0)
		rc = -EIO;
	close(fd);
	return rc == 0 && rename(part, path) < 0 ? -errno : rc;
}

static int store(void *context, const char *name, struct bytes file)
{
	const struct options *options = context;

	return keep(options->metadata_dir, name, file);
}

/* ---- requests */

static size_t take(char *data, size_t size, size_t count, void *context)
{
	struct buffer *out = context;

	buffer_put(out, data, size * count);
	return out->error ? 0 : size * count;
}

static int get(const struct options *options, const char *base, const char *name,
	       struct buffer *out)
{
	CURL *curl = curl_easy_init();
	char url[4096];
	long status = 0;
	CURLcode code;

	snprintf(url, sizeof(url), "%s%s%s", base, base[strlen(base) - 1] == '/' ? "" : "/", name);
	curl_easy_setopt(curl, CURLOPT_URL, url);
	curl_easy_setopt(curl, CURLOPT_PATH_AS_IS, 1L);
	if (options->ca)
		curl_easy_setopt(curl, CURLOPT_CAINFO, options->ca);
	curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
	curl_easy_setopt(curl, CURLOPT_FAILONERROR, 1L);
	curl_easy_setopt(curl, CURLOPT_TIMEOUT, 20L);
	curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, take);
	curl_easy_setopt(curl, CURLOPT_WRITEDATA, out);
	code = curl_easy_perform(curl);
	curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &status);
	curl_easy_cleanup(curl);
	if (code == CURLE_OK)
		return 0;
	if (status == 404 || status == 403)
		return -ENOENT;
	return out->error ? out->error : -EIO;
}

static int fetch(void *context, const char *name, struct buffer *out)
{
	const struct options *options = context;

	return get(options, options->metadata_url, name, out);
}

/* ---- commands */

static int init(const struct options *options, const char *root)
{
	struct buffer file;
	int rc;

	buffer_init(&file, 1 << 20);
	rc = buffer_read_file(&file, root);
	if (rc == 0)
		rc = keep(options->metadata_dir, "root.json", buffer_bytes(&file));
	buffer_finish(&file);
	return rc;
}

/* A target that is here already is not fetched again. */
static int fetch_target(const struct options *options, const struct tuf_target *target)
{
	char name[2048], path[PATH_MAX];
	struct buffer file;
	int rc = tuf_quote(name, sizeof(name), options->target_name);

	if (rc < 0)
		return rc;
	snprintf(path, sizeof(path), "%s/%s", options->target_dir, name);
	buffer_init(&file, target->length + 1);
	if (buffer_read_file(&file, path) == 0 && tuf_target_is(target, buffer_bytes(&file))) {
		buffer_finish(&file);
		return 0;
	}
	buffer_clear(&file);
	rc = get(options, options->target_url, target->file, &file);
	if (rc == 0 && !tuf_target_is(target, buffer_bytes(&file)))
		rc = -EBADMSG;
	if (rc == 0)
		rc = keep(options->target_dir, name, buffer_bytes(&file));
	if (rc < 0)
		fprintf(stderr, "tuf_client: %s: %s\n", target->file, strerror(-rc));
	buffer_finish(&file);
	return rc;
}

static int update(struct options *options, bool downloads)
{
	const struct tuf_io io = { options, fetch, load, store };
	struct tuf_client client;
	struct tuf_target target = { 0 };
	int rc = tuf_client_refresh(&client, &io, time(NULL));

	if (rc == 0 && downloads)
		rc = tuf_client_find(&client, options->target_name, &target);
	if (rc < 0)
		fprintf(stderr, "tuf_client: %s\n", client.why);
	else if (downloads)
		rc = fetch_target(options, &target);
	tuf_target_finish(&target);
	tuf_client_finish(&client);
	return rc;
}

int main(int argc, char **argv)
{
	static const struct option known[] = { { "metadata-dir", required_argument, NULL, 'm' },
					       { "metadata-url", required_argument, NULL, 'u' },
					       { "target-name", required_argument, NULL, 'n' },
					       { "target-base-url", required_argument, NULL, 'b' },
					       { "target-dir", required_argument, NULL, 'd' },
					       { "ca", required_argument, NULL, 'c' },
					       { 0 } };
	struct options options = { 0 };
	const char *command;
	int option;

	while ((option = getopt_long(argc, argv, "", known, NULL)) != -1) {
		switch (option) {
		case 'c':
			options.ca = optarg;
			break;
		case 'm':
			options.metadata_dir = optarg;
			break;
		case 'u':
			options.metadata_url = optarg;
			break;
		case 'n':
			options.target_name = optarg;
			break;
		case 'b':
			options.target_url = optarg;
			break;
		case 'd':
			options.target_dir = optarg;
			break;
		default:
			return 2;
		}
	}
	command = optind < argc ? argv[optind] : "";
	if (!options.metadata_dir)
		return 2;
	if (strcmp(command, "init") == 0 && optind + 1 < argc)
		return init(&options, argv[optind + 1]) < 0;
	if (strcmp(command, "refresh") == 0 && options.metadata_url)
		return update(&options, false) < 0;
	if (strcmp(command, "download") == 0 && options.metadata_url && options.target_name &&
	    options.target_url && options.target_dir)
		return update(&options, true) < 0;
	fprintf(stderr, "usage: see the head of tests/tools/tuf_client.c\n");
	return 2;
}
