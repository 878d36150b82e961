#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "health/machine.h"
#include "tests/check.h"

static char root[] = "/tmp/gopura-machine-XXXXXX";

/* A file below root, its folders made. */
static void write_file(const char *path, const char *text)
{
	char name[256];
	FILE *file;

	snprintf(name, sizeof(name), "%s%s", root, path);
	for (char *slash = name + sizeof(root); *slash; slash++) {
		if (*slash != '/')
			continue;
		*slash = '\0';
		mkdir(name, 0700);
		*slash = '/';
	}
	file = fopen(name, "w");
	CHECK(file);
	fputs(text, file);
	fclose(file);
}

static void read_it(struct machine *out)
{
	char faults[64];

	snprintf(faults, sizeof(faults), "%s/faults", root);
	machine_read(out, &(struct machine_options){ root, faults, root });
}

static int begin(void **state)
{
	(void)state;
	return mkdtemp(root) ? 0 : -1;
}

static int end(void **state)
{
	char command[64];

	(void)state;
	snprintf(command, sizeof(command), "rm -r %s", root);
	return system(command) == 0 ? 0 : -1;
}

static void what_is_not_there_is_not_told(void **state)
{
	struct machine m;

	(void)state;
	read_it(&m);
	CHECK(isnan(m.uptime_s) && isnan(m.temperature_c) && isnan(m.memory_bytes));
	CHECK(isnan(m.memory_free_bytes) && isnan(m.written_bytes));
	CHECK(m.slot[0] == '\0' && m.faults[0] == '\0' && m.name[0] != '\0');
	CHECK(m.data_plain[0] == '\0' && m.newer[0] == '\0' && !m.is_set_up);
	CHECK(m.data_lost[0] == '\0');
	CHECK(m.data_bytes > m.data_free_bytes && m.data_free_bytes > 0);
	machine_read(&m, &(struct machine_options){ root, "/nowhere", "/nowhere" });
	CHECK(isnan(m.data_bytes) && isnan(m.data_free_bytes));
}

static void the_kernels_files_are_understood(void **state)
{
	struct machine m;

	(void)state;
	write_file("/proc/uptime", "5402.51 10000.00\n");
	write_file("/proc/meminfo",
		   "MemTotal:        2000 kB\nMemFree: 1 kB\nMemAvailable:    1500 kB\n");
	write_file("/proc/cmdline", "root=/dev/sda2 rauc.slot=B quiet\n");
	write_file("/sys/class/thermal/thermal_zone0/temp", "41500\n");
	write_file("/sys/class/thermal/thermal_zone1/temp", "63250\n");
	write_file("/sys/class/thermal/thermal_zone3/temp", "nonsense\n");
	write_file("/sys/block/mmcblk0/stat", "  9 9 9 9 9 9 1000 9 9 9 9\n");
	write_file("/sys/block/sda/stat", "1 1 1 1 1 1 24 1 1 1 1 1 1 1 1 1 1\n");
	write_file("/sys/block/loop0/stat", "1 1 1 1 1 1 999999 1 1 1 1\n");
	write_file("/sys/block/dm-0/stat", "1 1 1 1 1 1 999999 1 1 1 1\n");
	write_file("/sys/block/sdb/stat", "");
	write_file("/faults", "gopura.conf, line 3: what\n");
	write_file("/run/gopura-data-plain", "No TPM.\n");
	write_file("/run/gopura-data-lost", "It cannot be read.\n");
	read_it(&m);
	CHECK(m.uptime_s == 5402.51);
	CHECK(m.memory_bytes == 2000 * 1024 && m.memory_free_bytes == 1500 * 1024);
	CHECK(strcmp(m.slot, "B") == 0);
	CHECK(m.temperature_c == 63.25);
	CHECK(m.written_bytes == 1024 * 512);
	CHECK(strcmp(m.faults, "gopura.conf, line 3: what\n") == 0 && m.is_set_up);
	CHECK(strcmp(m.data_plain, "No TPM.") == 0);
	CHECK(strcmp(m.data_lost, "It cannot be read.") == 0);
}

static void an_older_system_than_was_good_here_is_told(void **state)
{
	struct machine m;

	(void)state;
	write_file("/etc/os-release", "ID=debian\nIMAGE_VERSION=v100\nIMAGE_SEQUENCE=100\n");
	write_file("/var/lib/gopura-firmware/floor", "120 v120\n");
	read_it(&m);
	CHECK(strcmp(m.newer, "v120") == 0);
	write_file("/var/lib/gopura-firmware/floor", "100 v100\n");
	read_it(&m);
	CHECK(m.newer[0] == '\0');
	write_file("/etc/os-release", "ID=debian\n"); /* not an appliance */
	write_file("/var/lib/gopura-firmware/floor", "120 v120\n");
	read_it(&m);
	CHECK(m.newer[0] == '\0');
	write_file("/etc/os-release", "ID=debian\nIMAGE_SEQUENCE=100\n");
	write_file("/var/lib/gopura-firmware/floor", "12x");
	read_it(&m);
	CHECK(m.newer[0] == '\0');
}

static void long_files_are_cut(void **state)
{
	static char text[3 * MACHINE_FAULTS_BYTES_MAX];
	struct machine m;

	(void)state;
	memset(text, 'x', sizeof(text) - 1);
	memcpy(text, "rauc.slot=", 10);
	write_file("/faults", text);
	write_file("/proc/cmdline", text);
	write_file("/proc/uptime", text);
	read_it(&m);
	CHECK(strlen(m.faults) == MACHINE_FAULTS_BYTES_MAX - 1);
	CHECK(strlen(m.slot) == sizeof(m.slot) - 1);
	CHECK(isnan(m.uptime_s));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_not_there_is_not_told),
		cmocka_unit_test(the_kernels_files_are_understood),
		cmocka_unit_test(an_older_system_than_was_good_here_is_told),
		cmocka_unit_test(long_files_are_cut),
	};

	return cmocka_run_group_tests(tests, begin, end);
}
