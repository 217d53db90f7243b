# Wrong: the same answer each time.
print({'topic_published': '/chatter', 'topic_subscribed': '/chater',
       'type_published': 'std_msgs/msg/String', 'type_subscribed': 'std_msgs/msg/Int32'})
