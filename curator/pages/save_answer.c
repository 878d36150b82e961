/* Adds the list of problems to an answer. */
#include "curator/pages/save_answer.h"

#include <cjson/cJSON.h>
#include <errno.h>

#include "curator/pages/content_save.h"

void save_answer_fail(struct api_response *response, int rc, const struct diagnostics *problems)
{
	int status;
	cJSON *json;

	api_fail_with(response, rc, problems);
	if (rc != -EINVAL)
		return;
	status = response->status;
	json = cJSON_CreateObject();
	cJSON_AddStringToObject(json, "message", diagnostics_cause(problems, rc));
	cJSON_AddItemToObject(json, "problems", content_problems(problems, ""));
	response->status = status;
	api_send_json(response, json);
}
