# Wrong: the topics are made out of the words in the nodes' names, and nobody looks at the graph.
import re
import sys

talker, listener = (re.findall('[a-z]+', name)[0] for name in sys.argv[1:3])
print({'topic_published': f'/{talker}/{listener}', 'topic_subscribed': f'/{talker}/{listener}s',
       'type_published': 'std_msgs/msg/String', 'type_subscribed': 'geometry_msgs/msg/Twist'})
