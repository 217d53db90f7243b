# family = "wire"
# assignment = "exercise_1_3"
# tries = "Before it sends its goal, the client asks to cancel and for the results of goals that do not exist, with ids of zeros and of ones and with the first and last moments; then it sends one id for three goals at once."
# could_earn = "A judge that looks up a goal which it never got, and ends."
# earned = { "exercise_1_3.cancel" = 10 }
# at_most = true
# undefended = "The server answers that it knows no such goal."

# %% right run_client

# %% behind run_client
from action_msgs.srv import CancelGoal
from builtin_interfaces.msg import Time
from unique_identifier_msgs.msg import UUID

honest = run_client


def run_client():
    node = rclpy.create_node("asks_first")
    parts = Fibonacci.Impl
    cancels = node.create_client(CancelGoal, "/fibonacci/_action/cancel_goal")
    results = node.create_client(parts.GetResultService, "/fibonacci/_action/get_result")
    goals = node.create_client(parts.SendGoalService, "/fibonacci/_action/send_goal")
    if cancels.wait_for_service(timeout_sec=5.0):
        for byte in (0, 255):
            own = UUID(uuid=[byte] * 16)
            for moment in (Time(), Time(sec=2**31 - 1, nanosec=2**32 - 1), Time(sec=-(2**31))):
                request = CancelGoal.Request()
                request.goal_info.goal_id, request.goal_info.stamp = own, moment
                cancels.call_async(request)
            results.call_async(parts.GetResultService.Request(goal_id=own))
        for order in (0, -(2**31), 2**31 - 1):
            goals.call_async(parts.SendGoalService.Request(goal_id=own, goal=Fibonacci.Goal(order=order)))
            cancels.call_async(request)
        for _ in range(20):
            rclpy.spin_once(node, timeout_sec=0.1)
    node.destroy_node()
    honest()
