# family = "wire"
# assignment = "lab_1_4"
# tries = "The action client asks the judge's server for results of goals that nobody has sent, cancels at a time before all times, sends one goal's id twice, and publishes feedback and states in the server's place."
# could_earn = "A judge that ends over a goal that it does not know."
# earned = { "lab_1_4.client" = 2 }
# at_most = true
# undefended = "The judge's server answers that it knows no such goal."

# %% solution fibonacci
from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal
from builtin_interfaces.msg import Time
from unique_identifier_msgs.msg import UUID


def fibonacci(order, patience_sec=5.0):
    node = rclpy.create_node("fibonacci_client")
    if not ActionClient(node, Fibonacci, "fibonacci").wait_for_server(timeout_sec=patience_sec):
        raise TimeoutError("nobody offers the action fibonacci")
    impl, mine = Fibonacci.Impl, UUID(uuid=[1] * 16)
    goal = impl.SendGoalService.Request(goal_id=mine, goal=Fibonacci.Goal(order=order))
    back = CancelGoal.Request(goal_info=GoalInfo(goal_id=UUID(uuid=[9] * 16), stamp=Time(sec=-(2**31))))
    asked = [(impl.GetResultService, "get_result", impl.GetResultService.Request(goal_id=UUID(uuid=[n] * 16))) for n in range(9)]
    asked += [(impl.SendGoalService, "send_goal", goal)] * 2 + [(CancelGoal, "cancel_goal", back)]
    asked += [(impl.SendGoalService, "send_goal", impl.SendGoalService.Request(goal_id=mine, goal=Fibonacci.Goal(order=-order)))]
    states = node.create_publisher(GoalStatusArray, "fibonacci/_action/status", 10)
    pieces = node.create_publisher(impl.FeedbackMessage, "fibonacci/_action/feedback", 10)
    for kind, name, request in asked:
        client = node.create_client(kind, f"fibonacci/_action/{name}")
        client.wait_for_service(timeout_sec=1.0)
        client.call_async(request)
        states.publish(GoalStatusArray(status_list=[GoalStatus(status=117), GoalStatus(status=-7)]))
        pieces.publish(impl.FeedbackMessage(goal_id=mine))
        rclpy.spin_once(node, timeout_sec=0.05)
    raise TimeoutError("no answer")
