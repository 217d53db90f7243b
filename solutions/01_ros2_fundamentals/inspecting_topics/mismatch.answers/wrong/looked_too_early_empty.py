# Wrong: gives up at once, with an empty answer.
import sys

found = dict.fromkeys(['topic_published', 'topic_subscribed', 'type_published', 'type_subscribed'])
print(found)
