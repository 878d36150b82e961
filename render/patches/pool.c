/* A queue of jobs under one mutex, the threads that work on it, and a queue of answers. */
#include "render/patches/pool.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "format/scenery_code.h"
#include "format/scenery_texture_code.h"

enum { WORKERS_MAX = 16 };

struct job {
	struct job *next;
	struct pool_answer answer;
	uint8_t *object; /* owned */
	size_t object_bytes;
};

/* A singly linked list with a pointer to its end. */
struct queue {
	struct job *first, **last;
};

struct pool {
	pthread_mutex_t lock;
	pthread_cond_t work, idle;
	pthread_t workers[WORKERS_MAX];
	uint32_t worker_count, at_work;
	bool stopping;
	struct queue todo, done; /* under lock */
	struct lattice lattice;
	uint32_t busy; /* only used by the thread that gives and takes */
	int fd;
};

static void queue_init(struct queue *queue)
{
	queue->first = NULL;
	queue->last = &queue->first;
}

static void queue_put(struct queue *queue, struct job *job)
{
	job->next = NULL;
	*queue->last = job;
	queue->last = &job->next;
}

static struct job *queue_take(struct queue *queue)
{
	struct job *job = queue->first;
	if (!job)
		return NULL;
	queue->first = job->next;
	if (!queue->first)
		queue->last = &queue->first;
	return job;
}

static void job_destroy(struct job *job)
{
	pool_answer_finish(&job->answer);
	free(job->object);
	free(job);
}

static void queue_empty(struct queue *queue)
{
	for (struct job *job; (job = queue_take(queue));)
		job_destroy(job);
}

void pool_patch_finish(struct pool_patch *patch)
{
	patch_bvh_finish(&patch->bvh);
	patch_mesh_finish(&patch->mesh);
	free(patch->vertices);
	patch->vertices = NULL;
}

void pool_answer_finish(struct pool_answer *answer)
{
	free(answer->rgb);
	for (uint32_t i = 0; i < answer->patch_count; i++)
		pool_patch_finish(&answer->patches[i]);
	free(answer->patches);
	label_group_finish(&answer->labels);
	solid_finish(&answer->solid);
	scenery_finish(&answer->scenery);
	answer->rgb = NULL;
	answer->patches = NULL;
	answer->patch_count = 0;
}

/* ---- on a worker */

static int decode_tile(struct job *job)
{
	job->answer.rgb = malloc((size_t)SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX * 3);
	if (!job->answer.rgb)
		return -ENOMEM;
	struct bytes object = { job->object, job->object_bytes };
	return tile_decode(job->answer.rgb, SAMPLE_IMAGE_PX, object);
}

/* Replaces the vertices of the mesh by packed ones. */
static int pack(struct pool_patch *patch)
{
	struct patch_mesh *mesh = &patch->mesh;
	patch->vertices = malloc(mesh->vertex_count * sizeof(*patch->vertices));
	if (!patch->vertices)
		return -ENOMEM;
	for (uint32_t v = 0; v < mesh->vertex_count; v++) {
		const struct patch_vertex *from = &mesh->vertices[v];
		struct packed_vertex *to = &patch->vertices[v];
		*to = (struct packed_vertex){ 0 };
		for (int i = 0; i < 3 && patch->bvh.positions; i++)
			to->position[i] = patch->bvh.positions[v][i];
		memcpy(to->normal, from->normal, sizeof(to->normal));
		memcpy(to->colour, from->colour, sizeof(to->colour));
	}
	free(mesh->vertices);
	mesh->vertices = NULL;
	return 0;
}

static int decode_group(struct job *job, const struct lattice *lattice)
{
	struct patch_mesh meshes[GROUP_PATCHES_MAX];
	uint32_t count = 0;
	int rc = patch_group_decode(meshes, &count,
				    (struct bytes){ job->object, job->object_bytes });
	if (rc < 0)
		return rc;
	job->answer.patches = calloc(count + 1, sizeof(*job->answer.patches));
	if (!job->answer.patches) {
		for (uint32_t i = 0; i < count; i++)
			patch_mesh_finish(&meshes[i]);
		return -ENOMEM;
	}
	job->answer.patch_count = count;
	for (uint32_t i = 0; i < count; i++) {
		struct pool_patch *patch = &job->answer.patches[i];
		patch->mesh = meshes[i];
		if (rc == 0)
			rc = patch_bvh_init(&patch->bvh, &patch->mesh, lattice);
		if (rc == 0)
			rc = pack(patch);
	}
	return rc;
}

static void do_job(struct job *job, const struct lattice *lattice)
{
	int rc = -EINVAL;
	switch (job->answer.kind) {
	case POOL_TILE:
		rc = decode_tile(job);
		break;
	case POOL_GROUP:
		rc = decode_group(job, lattice);
		break;
	case POOL_LABELS:
		rc = label_group_decode(&job->answer.labels,
					(struct bytes){ job->object, job->object_bytes });
		break;
	case POOL_SOLID:
		rc = solid_decode(&job->answer.solid,
				  (struct bytes){ job->object, job->object_bytes });
		break;
	case POOL_SCENERY:
		rc = scenery_decode(&job->answer.scenery,
				    (struct bytes){ job->object, job->object_bytes });
		if (rc == 0)
			rc = scenery_decode_textures(&job->answer.scenery);
		break;
	}
	if (rc < 0)
		pool_answer_finish(&job->answer);
	job->answer.error = rc;
	free(job->object);
	job->object = NULL;
}

/* Runs one job. Called with the lock held, which is released while the job runs. Returns false
 * where there is none. */
static bool do_one(struct pool *pool)
{
	struct job *job = queue_take(&pool->todo);
	if (!job)
		return false;
	struct lattice lattice = pool->lattice;
	pool->at_work++;
	pthread_mutex_unlock(&pool->lock);
	do_job(job, &lattice);
	pthread_mutex_lock(&pool->lock);
	pool->at_work--;
	queue_put(&pool->done, job);
	pthread_cond_signal(&pool->idle);
	const uint64_t one = 1;
	/* The counter cannot overflow: it is reset whenever answers are taken. */
	ssize_t written = write(pool->fd, &one, sizeof(one));
	(void)written;
	return true;
}

static void *run_worker(void *data)
{
	struct pool *pool = data;
	pthread_mutex_lock(&pool->lock);
	while (!pool->stopping)
		if (!do_one(pool))
			pthread_cond_wait(&pool->work, &pool->lock);
	pthread_mutex_unlock(&pool->lock);
	return NULL;
}

/* ---- on the owner's thread */

int pool_create(struct pool **out, uint32_t worker_count)
{
	struct pool *pool = calloc(1, sizeof(*pool));
	*out = NULL;
	if (!pool)
		return -ENOMEM;
	queue_init(&pool->todo);
	queue_init(&pool->done);
	pthread_mutex_init(&pool->lock, NULL);
	pthread_cond_init(&pool->work, NULL);
	pthread_cond_init(&pool->idle, NULL);
	pool->fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	int rc = pool->fd < 0 ? -errno : 0;
	worker_count = worker_count > WORKERS_MAX ? WORKERS_MAX : worker_count;
	while (rc == 0 && pool->worker_count < worker_count) {
		rc = -pthread_create(&pool->workers[pool->worker_count], NULL, run_worker, pool);
		if (rc == 0)
			pool->worker_count++;
	}
	if (rc < 0) {
		pool_destroy(pool);
		return rc;
	}
	*out = pool;
	return 0;
}

void pool_destroy(struct pool *pool)
{
	if (!pool)
		return;
	pthread_mutex_lock(&pool->lock);
	pool->stopping = true;
	pthread_cond_broadcast(&pool->work);
	pthread_mutex_unlock(&pool->lock);
	for (uint32_t i = 0; i < pool->worker_count; i++)
		pthread_join(pool->workers[i], NULL);
	queue_empty(&pool->todo);
	queue_empty(&pool->done);
	pthread_cond_destroy(&pool->idle);
	pthread_cond_destroy(&pool->work);
	pthread_mutex_destroy(&pool->lock);
	if (pool->fd >= 0)
		close(pool->fd);
	free(pool);
}

void pool_set_lattice(struct pool *pool, const struct lattice *lattice)
{
	pthread_mutex_lock(&pool->lock);
	pool->lattice = *lattice;
	pthread_mutex_unlock(&pool->lock);
}

int pool_give(struct pool *pool, enum pool_kind kind, uint64_t id, struct bytes object)
{
	struct job *job = calloc(1, sizeof(*job));
	uint8_t *copy = malloc(object.size + 1);
	if (!job || !copy) {
		free(job);
		free(copy);
		return -ENOMEM;
	}
	if (object.size > 0)
		memcpy(copy, object.data, object.size);
	job->object = copy;
	job->object_bytes = object.size;
	job->answer.kind = kind;
	job->answer.id = id;
	pthread_mutex_lock(&pool->lock);
	queue_put(&pool->todo, job);
	pthread_cond_signal(&pool->work);
	if (pool->worker_count == 0)
		do_one(pool);
	pthread_mutex_unlock(&pool->lock);
	pool->busy++;
	return 0;
}

bool pool_take(struct pool *pool, struct pool_answer *answer)
{
	pthread_mutex_lock(&pool->lock);
	struct job *job = queue_take(&pool->done);
	pthread_mutex_unlock(&pool->lock);
	if (!job)
		return false;
	*answer = job->answer;
	job->answer = (struct pool_answer){ .rgb = NULL };
	job_destroy(job);
	pool->busy--;
	return true;
}

void pool_quiet(struct pool *pool)
{
	uint64_t count;
	ssize_t taken = read(pool->fd, &count, sizeof(count));
	(void)taken; /* fails where the descriptor was not readable */
}

uint32_t pool_busy(const struct pool *pool)
{
	return pool->busy;
}

void pool_forget(struct pool *pool)
{
	pthread_mutex_lock(&pool->lock);
	queue_empty(&pool->todo);
	while (pool->at_work > 0)
		pthread_cond_wait(&pool->idle, &pool->lock);
	queue_empty(&pool->done);
	pool->busy = 0;
	pthread_mutex_unlock(&pool->lock);
}

int pool_fd(const struct pool *pool)
{
	return pool->fd;
}
