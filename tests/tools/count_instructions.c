/* A plugin for QEMU's user emulation that counts what a program executes: instructions of all its
 * threads, for any architecture that QEMU emulates. Each write of the program to the descriptor -1
 * ends a count and begins the next: the count is printed on standard error.
 *
 *   qemu-x86_64 -plugin build/tests/tools/count_instructions.so PROGRAM
 *
 * Debian 12 has no package with the header of QEMU's plugins, so what is used of the interface
 * (version 1, of QEMU 7.2) is declared here. */
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

struct qemu_plugin_tb; /* translated code without a branch in it */
typedef uint64_t qemu_plugin_id_t;
typedef void (*translated_cb)(qemu_plugin_id_t id, struct qemu_plugin_tb *block);
typedef void (*executed_cb)(unsigned int cpu, void *data);
typedef void (*called_cb)(qemu_plugin_id_t id, unsigned int cpu, int64_t number, uint64_t a1,
			  uint64_t a2, uint64_t a3, uint64_t a4, uint64_t a5, uint64_t a6,
			  uint64_t a7, uint64_t a8);
struct qemu_info {
	const char *architecture;
	/* and more, which is not used */
};

void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t id, translated_cb cb);
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb *block, executed_cb cb, int flags,
					  void *data);
void qemu_plugin_register_vcpu_syscall_cb(qemu_plugin_id_t id, called_cb cb);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *block);

#define EXPORTED __attribute__((visibility("default")))
EXPORTED extern const int qemu_plugin_version;
EXPORTED int qemu_plugin_install(qemu_plugin_id_t id, const struct qemu_info *info, int count,
				 char **arguments);
const int qemu_plugin_version = 1;

enum { CPUS = 256 /* threads at a time */ };

static uint64_t executed[CPUS]; /* each is written by one thread */
static uint64_t told;
static int64_t write_number;

static void on_executed(unsigned int cpu, void *data)
{
	executed[cpu % CPUS] += (uintptr_t)data;
}

static void on_translated(qemu_plugin_id_t id, struct qemu_plugin_tb *block)
{
	const uintptr_t count = qemu_plugin_tb_n_insns(block);
	(void)id;
	qemu_plugin_register_vcpu_tb_exec_cb(block, on_executed, 0, (void *)count);
}

static void on_called(qemu_plugin_id_t id, unsigned int cpu, int64_t number, uint64_t a1,
		      uint64_t a2, uint64_t a3, uint64_t a4, uint64_t a5, uint64_t a6, uint64_t a7,
		      uint64_t a8)
{
	uint64_t now = 0;
	(void)id, (void)cpu, (void)a2, (void)a3, (void)a4, (void)a5, (void)a6, (void)a7, (void)a8;
	if (number != write_number || (int32_t)a1 != -1)
		return;
	for (int i = 0; i < CPUS; i++)
		now += executed[i];
	fprintf(stderr, "instructions: %" PRIu64 "\n", now - told);
	told = now;
}

int qemu_plugin_install(qemu_plugin_id_t id, const struct qemu_info *info, int count,
			char **arguments)
{
	(void)count, (void)arguments;
	write_number = strcmp(info->architecture, "x86_64") == 0 ? 1 : 64;
	qemu_plugin_register_vcpu_tb_trans_cb(id, on_translated);
	qemu_plugin_register_vcpu_syscall_cb(id, on_called);
	return 0;
}
