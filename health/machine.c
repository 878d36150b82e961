/* Reads memory, temperature, disk writes, uptime and firmware slot from /proc and /sys, the room on
 * the data partition, why that is not encrypted or not used (notes by image/init), which system was
 * found good (a note by gopura-good), and the file of set-up faults. */
#include "health/machine.h"

#include <dirent.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>
#include <unistd.h>

enum { ZONES_MAX = 64, SECTOR_BYTES = 512 };

/* Reads the beginning of a file into out, terminated; "" if it cannot be read. Returns whether it
 * could be opened. */
static bool read_text(char *out, size_t out_bytes, const char *root, const char *path)
{
	char name[PATH_MAX];
	FILE *file;
	size_t size = 0;

	snprintf(name, sizeof(name), "%s%s", root, path);
	file = fopen(name, "re");
	if (file) {
		size = fread(out, 1, out_bytes - 1, file);
		fclose(file);
	}
	out[size] = '\0';
	return file;
}

/* The same, of its first line. */
static void read_line(char *out, size_t out_bytes, const char *root, const char *path)
{
	read_text(out, out_bytes, root, path);
	out[strcspn(out, "\n")] = '\0';
}

static double number_after(const char *text, const char *word)
{
	const char *at = strstr(text, word);
	double value;

	return at && sscanf(at + strlen(word), "%lf", &value) == 1 ? value : NAN;
}

static void read_memory(struct machine *out, const char *root)
{
	char text[1024];

	read_text(text, sizeof(text), root, "/proc/meminfo");
	out->memory_bytes = number_after(text, "MemTotal:") * 1024;
	out->memory_free_bytes = number_after(text, "MemAvailable:") * 1024;
}

/* Reads the firmware slot: the word after rauc.slot= on the kernel's command line. */
static void read_slot(struct machine *out, const char *root)
{
	char text[2048], format[32];
	const char *at;

	read_text(text, sizeof(text), root, "/proc/cmdline");
	at = strstr(text, "rauc.slot=");
	snprintf(format, sizeof(format), "rauc.slot=%%%zu[0-9A-Za-z._-]", sizeof(out->slot) - 1);
	if (!at || sscanf(at, format, out->slot) != 1)
		out->slot[0] = '\0';
}

/* Compares the version floor, "SEQUENCE VERSION", with the running system. */
static void read_newer(struct machine *out, const char *root)
{
	char text[4096];
	double sequence, running;

	_Static_assert(sizeof(out->newer) == 64, "the format has its length");

	read_text(text, sizeof(text), root, "/etc/os-release");
	running = number_after(text, "\nIMAGE_SEQUENCE=");
	read_text(text, sizeof(text), root, "/var/lib/gopura-firmware/floor");
	if (sscanf(text, "%lf %63s", &sequence, out->newer) != 2 || !(sequence > running))
		out->newer[0] = '\0';
}

static double hottest_c(const char *root)
{
	double hottest = NAN;

	for (int i = 0; i < ZONES_MAX; i++) {
		char path[64], text[32];
		int milli;

		snprintf(path, sizeof(path), "/sys/class/thermal/thermal_zone%d/temp", i);
		read_text(text, sizeof(text), root, path);
		if (sscanf(text, "%d", &milli) == 1)
			hottest = fmax(hottest, milli / 1000.0); /* fmax ignores NAN */
	}
	return hottest;
}

/* Returns whether a block device is a disk that wears: not one that lies on another device or in
 * memory. */
static bool is_disk(const char *name)
{
	static const char *const others[] = { ".", "loop", "ram", "zram", "sr", "dm-", "md" };

	for (size_t i = 0; i < ARRAY_COUNT(others); i++)
		if (strncmp(name, others[i], strlen(others[i])) == 0)
			return false;
	return true;
}

static double written_bytes(const char *root)
{
	char folder[PATH_MAX];
	struct dirent *entry;
	double total = NAN;
	DIR *block;

	snprintf(folder, sizeof(folder), "%s/sys/block", root);
	block = opendir(folder);
	while (block && (entry = readdir(block))) {
		char path[300], text[256];
		unsigned long long sectors;

		if (!is_disk(entry->d_name))
			continue;
		snprintf(path, sizeof(path), "/sys/block/%s/stat", entry->d_name);
		read_text(text, sizeof(text), root, path);
		if (sscanf(text, "%*u %*u %*u %*u %*u %*u %llu", &sectors) == 1)
			total = (isnan(total) ? 0 : total) + (double)sectors * SECTOR_BYTES;
	}
	if (block)
		closedir(block);
	return total;
}

static void read_data(struct machine *out, const char *folder)
{
	struct statvfs room;

	out->data_bytes = out->data_free_bytes = NAN;
	if (statvfs(folder, &room) < 0 || room.f_blocks == 0)
		return;
	out->data_bytes = (double)room.f_blocks * (double)room.f_frsize;
	out->data_free_bytes = (double)room.f_bavail * (double)room.f_frsize;
}

void machine_read(struct machine *out, const struct machine_options *options)
{
	char text[128];

	memset(out, 0, sizeof(*out));
	if (gethostname(out->name, sizeof(out->name) - 1) < 0)
		out->name[0] = '\0';
	read_text(text, sizeof(text), options->root, "/proc/uptime");
	out->uptime_s = number_after(text, "");
	out->temperature_c = hottest_c(options->root);
	out->written_bytes = written_bytes(options->root);
	read_memory(out, options->root);
	read_slot(out, options->root);
	read_newer(out, options->root);
	read_data(out, options->data);
	read_line(out->data_plain, sizeof(out->data_plain), options->root,
		  "/run/gopura-data-plain");
	read_line(out->data_lost, sizeof(out->data_lost), options->root, "/run/gopura-data-lost");
	out->is_set_up = read_text(out->faults, sizeof(out->faults), "", options->faults);
}
